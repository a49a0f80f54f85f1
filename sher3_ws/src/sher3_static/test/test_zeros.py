"""Zeros that differ from run to run: free in every kind of table, told in the notes, and never a cause."""

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from sher3_machines import kinds
from sher3_static.kind import TableKind

TABLES = {name: kind for name, kind in kinds().items() if isinstance(kind, TableKind)}


def verdict_of(described, *data):
    kind = TABLES[described["kind"]]
    known = kind.description.model_validate(described)
    return diagnose(kind.machine(known), [kind.read(f"run {i}", x, known) for i, x in enumerate(data)]).verdict


def told(verdict):
    return [note for note in verdict.notes if "from run to run: free in each" in note]


CELL = {
    "kind": "load_cell",
    "name": "cell",
    "applied": {"column": "n", "unit": "N"},
    "reading": {"column": "r", "unit": "N"},
}


def weighed(zero, gain=1.0, seed=1):
    force = np.tile(np.concatenate([np.arange(0.0, 501.0, 50.0), np.arange(450.0, 0.0, -50.0)]), 2)
    noise = np.random.default_rng(seed).normal(0.0, 0.05, len(force))
    return {"n": force, "r": gain * force + zero + noise}


def test_zeros_of_a_cell():
    verdict = verdict_of(CELL, weighed(-2.0), weighed(2.0, seed=2))
    assert verdict.status == "no_gap"
    assert told(verdict) == ["cell: zeros differ by 4 N from run to run: free in each, and no cause"]
    verdict = verdict_of(CELL, weighed(-2.0, 0.99), weighed(2.0, 0.99, seed=2))
    assert [c.effect for c in verdict.causes] == ["force_scale"]
    assert verdict.causes[0].parameters["relative"].value == pytest.approx(-0.01, rel=0.05)


def test_a_zero_that_stays_is_a_bias():
    verdict = verdict_of(CELL, weighed(2.0), weighed(2.0, seed=2))
    assert [c.effect for c in verdict.causes] == ["force_bias"] and not told(verdict)


AXIS = {
    "kind": "positioning",
    "name": "test",
    "axes": [{"name": "x", **{name: {"column": name, "unit": "m"} for name in ("target", "reading")}}],
}


def table(zero, reversal=0.0, cycles=1, seed=1):
    there = np.linspace(0.0, 0.5, 11)
    target, side = np.tile([*there, *there[::-1]], cycles), np.tile(np.repeat([1.0, -1.0], 11), cycles)
    noise = np.random.default_rng(seed).normal(0.0, 0.3e-6, len(target))
    return {"target": target, "reading": target + zero - side * reversal / 2 + noise}


@pytest.mark.parametrize("cycles", [1, 3])
def test_zeros_of_a_positioning_test(cycles):
    """A file for each cycle or for three: the reference was set to zero before each."""
    runs = [table(zero, cycles=cycles, seed=k) for k, zero in enumerate((0.0, 4e-5, -3e-5, 1e-5))]
    assert verdict_of(AXIS, *runs).status == "no_gap" and told(verdict_of(AXIS, *runs))
    runs = [table(zero, 6e-6, cycles, k) for k, zero in enumerate((0.0, 4e-5, -3e-5, 1e-5))]
    (cause,) = verdict_of(AXIS, *runs).causes
    assert cause.effect == "backlash" and cause.parameters["width"].value == pytest.approx(6e-6, rel=0.1)


BAR = {
    "kind": "positioning",
    "name": "bar",
    "planes": [
        {
            "name": "xy",
            "angle": {"column": "a", "unit": "deg"},
            "deviation": {"column": "r", "unit": "um"},
            "radius": 0.1,
        }
    ],
}


def turned(sense, zero, aside, reversal=0.0):
    """Deviations of a ball bar whose length is off by `zero` and whose centre lies aside, um."""
    angle = np.radians(sense * np.arange(0.0, 360.0, 0.5))
    noise = np.random.default_rng(5 + sense).normal(0.0, 0.2, len(angle))
    moving = np.sign(sense * np.cos(angle))
    off = zero + aside * np.cos(angle) - 0.5 * reversal * np.sin(angle) * moving
    return {"a": np.degrees(angle) % 360.0, "r": off + noise}


def test_zeros_of_a_ball_bar():
    """The bar was set up again before it turned the other way: its length and its centre are others."""
    assert verdict_of(BAR, turned(1, 10.0, 20.0), turned(-1, -15.0, -40.0)).status == "no_gap"
    verdict = verdict_of(BAR, turned(1, 10.0, 20.0, 8.0), turned(-1, -15.0, -40.0, 8.0))
    (cause,) = verdict.causes
    assert cause.effect == "backlash" and cause.actuator == "xy.y"
    assert cause.parameters["width"].value == pytest.approx(8e-6, rel=0.1)


def test_every_table_has_pages_that_are_written_for_it():
    assert set(TABLES) == {"arm", "force_sensor", "load_cell", "positioning"}
    for kind in TABLES.values():
        assert kind.library() and all(set(page.kinds) & set(kind.written_for) for page in kind.library())
