"""Drafts of positioning tests: tables as ISO 230-2 protocols have them become a description that finds the errors."""

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from sher3_machines import import_case, open_case
from sher3_machines.drafting.drafts import draft_of

STEPS = np.linspace(0.0, 500.0, 11)
TARGET = np.tile(np.concatenate([STEPS, STEPS[::-1]]), 5)
SIDE = np.tile(np.repeat([1, -1], 11), 5)
CYCLE = np.repeat(np.arange(1, 6), 22)
OFF = -SIDE * 2e-3 + 2e-5 * (TARGET - 250.0) + 3e-4 * np.random.default_rng(1).normal(size=len(TARGET))
"""mm: 4 um of reversal and 20 um per metre."""
WARM = 20.0 + np.linspace(0.0, 0.5, len(TARGET))


def drafted(tmp_path, header, rows):
    lines = [header, *(";".join(str(x) for x in row) for row in rows)]
    (tmp_path / "a.csv").write_text("\n".join(lines), encoding="utf-8")
    return draft_of(tmp_path / "a.csv")


def errors(tmp_path, found):
    """Import with a draft; return the causes with their first parameters."""
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    causes = diagnose(*open_case(tmp_path / "case")).verdict.causes
    return {c.effect: next(iter(c.parameters.values())).value for c in causes}


WHOLE = {"backlash": pytest.approx(4e-6, rel=0.1), "lead_error": pytest.approx(2e-5, rel=0.1)}


def test_a_protocol_with_its_reference_cycle_side_and_temperature(tmp_path):
    header = "cycle;target [mm];reference [mm];direction;temperature [°C]"
    rows = zip(CYCLE, TARGET, TARGET + OFF, SIDE, WARM, strict=True)
    found = drafted(tmp_path, header, rows)
    assert "kind: positioning" in found.text and all(f"  {k}:" in found.text for k in ("cycle", "direction"))
    assert "unit: degC" in found.text
    assert errors(tmp_path, found) == WHOLE


def test_a_german_one_whose_sides_are_signs(tmp_path):
    rows = zip(CYCLE, TARGET, TARGET + OFF, np.where(SIDE > 0, "+", "-"), strict=True)
    found = drafted(tmp_path, "Zyklus;Sollposition (mm);Istposition (mm);Richtung", rows)
    assert any("direction from the order of the rows" in x for x in found.guesses)
    assert errors(tmp_path, found) == WHOLE


def test_deviations_without_units(tmp_path):
    found = drafted(tmp_path, "target;deviation", zip(TARGET, 1e3 * OFF, strict=True))
    assert "unit: um" in found.text and "unit: mm" in found.text
    assert errors(tmp_path, found) == WHOLE


@pytest.mark.parametrize("apart", [False, True])
def test_a_column_for_each_pass(tmp_path, apart):
    """In turn, or all upward passes first: a deviation in proportion to the target is a lead error, and no reading."""
    passes = 1e3 * OFF.reshape(10, 11)
    passes[1::2] = passes[1::2, ::-1]
    order = [*range(0, 10, 2), *range(1, 10, 2)] if apart else range(10)
    names = ";".join(f"{'down' if i % 2 else 'up'}_{i // 2 + 1}_um" for i in order)
    found = drafted(tmp_path, f"Target_mm;{names}", np.column_stack([STEPS, passes[list(order)].T]))
    assert errors(tmp_path, found) == WHOLE


def test_a_record_in_time_is_none(tmp_path):
    clock = 0.01 * np.arange(len(TARGET))
    found = drafted(tmp_path, "time;target_mm;measured_mm", zip(clock, TARGET, TARGET + OFF, strict=True))
    assert "kind: axes" in found.text


def test_a_speed_that_is_asked_for_is_no_target(tmp_path):
    """A robot's log without a word for its clock: speeds of a move hold for many rows, its places do not."""
    t = np.arange(0.0, 8.0, 0.008)
    speed = np.where(np.sin(0.8 * t) > 0.0, 0.5, -0.37)
    place = np.cumsum(speed) * 0.008
    header = "pc_ts;actual_q_0;target_q_0;actual_qd_0;target_qd_0"
    rows = zip(1.7e9 + t, place + 1e-5, place, speed + 1e-4 * np.cos(9.0 * t), speed, strict=True)
    assert "kind: axes" in drafted(tmp_path, header, rows).text
