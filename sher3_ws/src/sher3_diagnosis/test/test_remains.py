"""What a cause leaves, by hand: where its law may hold anything up to a level, only what is beyond counts."""

import numpy as np
import pytest
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.quantify.remains import excess_of, remains
from toy import AXIS, Column, ToyRun, evidence_of


class Sticking(Column):
    """A force against the motion; at rest it is any force up to its size."""

    def held(self, view, site, shape, coefficients):
        return np.where(view.run.velocity == 0.0, abs(float(coefficients[0])), 0.0)


def left_of(effect):
    """Moving it takes 3 N, at rest 2, -3.5 and 0 N were needed; five runs alike."""
    values, velocity = np.array([3.0, -3.0, 2.0, -3.5, 0.0]), np.array([1.0, -1.0, 0.0, 0.0, 0.0])
    evidence = evidence_of([ToyRun("a", values, np.zeros(5), velocity) for _ in range(5)], floor=0.5)
    found = fit(evidence.data, [make_term(evidence.data, effect, "axis", {})])
    left = remains(evidence, found, 0, AXIS)
    return left[0][:, 0], excess_of(evidence, AXIS, left)


def test_at_rest_only_what_is_beyond_the_level_is_left():
    left, excess = left_of(Sticking("sticking", "friction", "direction"))
    assert left == pytest.approx([0.0, 0.0, 0.0, -0.5, 0.0], abs=1e-4)
    assert excess == pytest.approx(5.0 * (1.0 - 5.0), abs=1e-2)  # half a newton is one floor


def test_a_law_whose_state_is_recorded_leaves_what_its_fit_leaves():
    left, excess = left_of(Column("sliding", "friction", "direction"))
    assert left == pytest.approx([0.0, 0.0, 2.0, -3.5, 0.0], abs=1e-4)
    assert excess == pytest.approx(5.0 * (16.0 + 49.0 - 5.0), abs=1e-2)
