"""Beside a cause with a rival a size is what either explanation leaves of it."""

import numpy as np
import pytest
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.quantify.over_rivals import LEAST, over_rivals
from sher3_diagnosis.verdict import Parameter
from toy import DIRECTION, OFFSET, SPEED, ToyRun, evidence_of

WIDTH = 0.1


def told(rivals, value=3.0, width=WIDTH):
    """3 + 2 sign(v): beside a friction by the speed, 12/11 of it, the offset is 3 - 0.5 * 12/11."""
    run = ToyRun("a", np.array([5.0, 5.0, 1.0, 1.0]), np.zeros(4), np.array([3.0, 1.0, -1.0, -1.0]))
    data = evidence_of([run, run]).data
    offset, direction, speed = (make_term(data, effect, "axis", {}) for effect in (OFFSET, DIRECTION, SPEED))
    other = ((fit(data, [offset, speed]),),) if rivals else ((),)
    found = Attribution(fit(data, [offset, direction]), ((), *other), (1.0, 1.0))
    size = Parameter(value=value, low=value - width, high=value + width, unit="N")
    return over_rivals(found, 0, {"size": size})["size"], over_rivals(found, 1, {"size": size})["size"]


def test_an_interval_holds_what_the_rival_of_another_cause_leaves():
    offset, direction = told(rivals=True)
    assert (offset.value, offset.high) == (3.0, 3.0 + WIDTH)
    assert offset.low == pytest.approx(3.0 - 6.0 / 11.0 - WIDTH, abs=1e-4)
    assert direction.low == 3.0 - WIDTH  # its own rivals say nothing of its own size


def test_without_rivals_it_stays():
    assert told(rivals=False)[0].low == 3.0 - WIDTH


def test_a_size_keeps_its_sign():
    assert told(rivals=True, value=9.0, width=8.5)[0].low == pytest.approx(LEAST * 0.5)
