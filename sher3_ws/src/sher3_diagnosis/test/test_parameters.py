"""Parameters with intervals, by hand: from runs that differ, from parts of the motion that want another size."""

from dataclasses import replace
from typing import ClassVar

import numpy as np
import pytest
from sher3_diagnosis.attribute.polish import polished
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Channel, Residual
from sher3_diagnosis.effect import Signature
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.quantify.parameters import parameters
from sher3_diagnosis.thresholds import BEYOND, HIDDEN, MIN_RUNS, MISFIT, NORMAL
from toy import AXIS, OFFSET, Column, ToyRun, evidence_of

BEYOND_AXIS = Channel("motor_mechanics", "beyond")
LEFT = 21.25 / 100.0


def found(values, rotary=frozenset(), effect=OFFSET):
    runs = [ToyRun("a", np.full(2, v), np.zeros(2), np.ones(2)) for v in values]
    evidence = evidence_of(runs, rotary=rotary)
    return parameters(evidence, fit(evidence.data, [make_term(evidence.data, effect, "axis", {})]), 0)["size"]


def test_the_interval_is_that_of_runs_that_differ():
    """Offsets 1..5: mean 3, scores of the runs -4 -2 0 2 4, an information of 10; parts of the motion do not differ.

    Of a loss of 110 of ten samples, 100 over the floor, the means of the other runs leave 31.25, so 21.25 over it.
    """
    size = found([1.0, 2.0, 3.0, 4.0, 5.0])
    noise, scatter = np.sqrt(1.0 / 10.0), np.sqrt(40.0 * 5.0 / 4.0 / 10.0**2)
    misfit = np.hypot(MISFIT * np.sqrt(LEFT), HIDDEN / np.sqrt(11.0))  # squares of 1 to 5: 11 on average
    half = np.hypot(NORMAL * noise, BEYOND * np.hypot(scatter, misfit * 3.0))
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


def test_a_law_that_leaves_a_share_of_its_gap_is_less_sure_than_one_that_leaves_nothing():
    """The same offset in all runs, once beside a wave that the law lacks and that no cut of the data shows."""
    halves = []
    for wave in (0.0, 2.0):
        values = 3.0 + wave * np.tile([1.0, -1.0, -1.0, 1.0], 16)
        runs = [ToyRun("a", values, np.zeros(64), np.ones(64)) for _ in range(MIN_RUNS)]
        evidence = evidence_of(runs)
        size = parameters(evidence, fit(evidence.data, [make_term(evidence.data, OFFSET, "axis", {})]), 0)["size"]
        assert size.value == pytest.approx(3.0, rel=1e-5)
        halves.append(size.high - size.value)
    noise = NORMAL / np.sqrt(64.0 * MIN_RUNS)
    assert halves[0] == pytest.approx(np.hypot(noise, BEYOND * HIDDEN / 3.0 * 3.0), rel=1e-3)  # 3 floors
    left = 3.0 / 12.0  # squares of 4 and a floor of 1, of squares of 9 + 4 and a floor of 1
    misfit = np.hypot(MISFIT * np.sqrt(left), HIDDEN / np.sqrt(9.0 + 4.0))
    assert halves[1] == pytest.approx(np.hypot(noise, BEYOND * misfit * 3.0), rel=1e-3)


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
    assert power.low < 1.5 < power.high and power.high - power.low < 0.12
    assert after.fit.total < start.total


def test_few_runs_carry_no_interval():
    assert found([1.0] * (MIN_RUNS - 1)).low is None


def test_a_choice_has_no_interval():
    assert found([1.0] * MIN_RUNS, effect=Column("member", "scale", "one", discrete=frozenset({"size"}))).low is None


def test_units_turn_with_the_axis():
    assert found([1.0] * 5, rotary=frozenset({"axis"})).unit == "N*m"


class Load(Column):
    """What a second channel feels by itself, and the first as it does the offset."""

    def channels(self, site):
        return frozenset({AXIS, BEYOND_AXIS})

    def signature(self, view, site, shape):
        n = len(view.run.values)
        return Signature(
            {AXIS: np.ones((n, 1, 1)) + 1e-3 * view.run.position[:, None, None], BEYOND_AXIS: np.ones((n, 1, 1))}
        )


def test_a_channel_that_carries_a_load_tells_it_from_what_another_cannot():
    """On the first channel load and offset are the same but for a thousandth; the second feels the load alone."""
    rng, n = np.random.default_rng(0), 200
    runs = [ToyRun("a", rng.normal(size=n) + 9.0, rng.normal(size=n), np.ones(n)) for _ in range(MIN_RUNS)]
    ok = np.ones(n, dtype=bool)
    seen = [
        {AXIS: Residual(r.values[:, None], ok), BEYOND_AXIS: Residual(rng.normal(size=(n, 1)) + 5, ok)} for r in runs
    ]
    one = evidence_of(runs)
    data = Standardised(one.views, seen, [{AXIS: np.ones(1), BEYOND_AXIS: np.ones(1)} for _ in runs])
    evidence = replace(one, data=data, units={AXIS: "N", BEYOND_AXIS: "N"})
    terms = [make_term(data, effect, "axis", {}) for effect in (Load("load", "load", "one"), OFFSET)]
    size = parameters(evidence, fit(data, terms), 1)["size"]
    assert size.low < 4.0 < size.high < 5.0
