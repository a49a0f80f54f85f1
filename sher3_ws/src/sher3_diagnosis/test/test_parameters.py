"""Parameters with intervals, by hand: from runs that differ, from parts of the motion that want another size."""

from typing import ClassVar

import numpy as np
import pytest
from scipy.stats import t as student
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.effect import Signature
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.quantify.parameters import parameters
from sher3_diagnosis.quantify.polish import polished
from sher3_diagnosis.thresholds import MIN_RUNS
from toy import AXIS, OFFSET, Column, ToyRun, evidence_of


def found(values, rotary=frozenset(), effect=OFFSET):
    runs = [ToyRun("a", np.full(2, v), np.zeros(2), np.ones(2)) for v in values]
    evidence = evidence_of(runs, rotary=rotary)
    return parameters(evidence, fit(evidence.data, [make_term(evidence.data, effect, "axis", {})]), 0)["size"]


def test_the_interval_is_that_of_runs_that_differ():
    """Offsets 1..5: mean 3, scores of the runs -4 -2 0 2 4, an information of 10, effective freedom 40^2 / 544 - 1."""
    size = found([1.0, 2.0, 3.0, 4.0, 5.0])
    half = student.ppf(0.975, 40.0**2 / 544.0 - 1.0) * np.sqrt(40.0 * 5.0 / 4.0) / 10.0
    assert size.value == pytest.approx(3.0, rel=1e-5)
    assert (size.low, size.high) == (pytest.approx(3.0 - half, rel=1e-3), pytest.approx(3.0 + half, rel=1e-3))
    assert size.unit == "N"


def test_a_law_that_wants_another_size_in_each_part_of_the_motion_is_unsure_of_it():
    """Runs alike, first half 2, second half 4: by runs nothing differs, by parts of the motion the size does."""
    halves = [ToyRun("a", np.repeat([2.0, 4.0], 4), np.zeros(8), np.ones(8)) for _ in range(MIN_RUNS)]
    evidence = evidence_of(halves)
    size = parameters(evidence, fit(evidence.data, [make_term(evidence.data, OFFSET, "axis", {})]), 0)["size"]
    assert size.value == pytest.approx(3.0, rel=1e-5)
    assert size.low < 2.0 and size.high > 4.0


class Power(Column):
    """The speed to a power that is a shape."""

    finer: ClassVar = {"power": (0.8, 1.25)}

    def signature(self, view, site, shape):
        speed = np.abs(view.run.velocity) ** shape["power"]
        return Signature({AXIS: speed[:, None, None]})

    def parameters(self, shape, coefficients):
        return {"size": float(coefficients[0]), **shape}


def test_a_shape_is_polished_beyond_its_grid_and_has_an_interval_of_its_own():
    """Truth: 6 |v|^1.5, searched at powers of 1.2 and neighbours by hand: the polished one is 1.5."""
    rng = np.random.default_rng(0)
    runs = []
    for excitation in ("a", "a", "a", "b", "b"):
        v = rng.uniform(-1.0, 1.0, 400)
        runs.append(ToyRun(excitation, 6.0 * np.abs(v) ** 1.5 + 0.2 * rng.normal(size=400), np.zeros(400), v))
    evidence = evidence_of(runs, floor=0.2)
    effect = Power("power", "friction", "velocity")
    start = fit(evidence.data, [make_term(evidence.data, effect, "axis", {"power": 1.4})])
    after = polished(evidence, Attribution(start, ((),), (1.0,)))
    power = parameters(evidence, after.fit, 0)["power"]
    assert power.value == pytest.approx(1.5, abs=0.03)
    assert power.low < 1.5 < power.high and power.high - power.low < 0.1
    assert after.fit.total < start.total


def test_few_runs_carry_no_interval():
    assert found([1.0] * (MIN_RUNS - 1)).low is None


def test_a_choice_has_no_interval():
    assert found([1.0] * MIN_RUNS, effect=Column("member", "scale", "one", discrete=frozenset({"size"}))).low is None


def test_units_turn_with_the_axis():
    assert found([1.0] * 5, rotary=frozenset({"axis"})).unit == "N*m"
