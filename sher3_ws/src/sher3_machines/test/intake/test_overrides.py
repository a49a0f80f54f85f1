"""What a description sets right: a clock's unit, an offset, a sign; and recorded speeds that contradict it."""

import numpy as np
import pytest
from sher3_machines import MachineError, import_case, load_description, open_case
from sher3_machines.drafting.draft import draft
from sher3_machines.intake.columns import pick
from sher3_machines.intake.fields import Column

T = 0.002 * np.arange(1500)
Q = 0.3 * np.sin(3.0 * T) + 0.1 * np.sin(7.0 * T)
V = 0.9 * np.cos(3.0 * T) + 0.7 * np.cos(7.0 * T)


def write(tmp_path, header, *columns):
    np.savetxt(tmp_path / "a.csv", np.column_stack(columns), delimiter=",", header=header, comments="")


def case(tmp_path, columns, text=None):
    """Write columns, describe them as drafted or by this text, and import them; the run and the notes."""
    np.savetxt(
        tmp_path / "a.csv",
        np.column_stack(list(columns.values())),
        delimiter=",",
        header=",".join(columns),
        comments="",
    )
    (tmp_path / "a.yaml").write_text(text or draft(tmp_path / "a.csv").text, encoding="utf-8")
    notes = import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    return open_case(tmp_path / "case")[1][0], notes


def test_an_offset_is_added_after_the_scale():
    assert pick(
        Column(column="q", unit="mm", factor=2.0, offset=-0.5), {"q": np.array([250.0, 500.0])}, "a"
    ).tolist() == [0.0, 0.5]


def test_a_header_with_the_wrong_unit_is_overruled():
    data = {"q [deg]": np.array([1.0, 2.0])}
    with pytest.raises(MachineError, match="where the header is wrong, add `override: true`"):
        pick(Column(column="q", unit="rad"), data, "a")
    assert pick(Column(column="q", unit="rad", override=True), data, "a").tolist() == [1.0, 2.0]
    with pytest.raises(ValueError, match="`override` needs the `unit`"):
        Column(column="q", override=True)


def test_stamps_in_seconds_under_a_header_of_milliseconds_are_told_by_the_speed(tmp_path):
    run, _ = case(tmp_path, {"Time [ms]": T, "q [rad]": Q, "dq [rad/s]": V, "tau [Nm]": V})
    assert run.period == pytest.approx(0.002)
    found = load_description(tmp_path / "a.yaml")
    assert found.time.unit == "s" and found.time.override


def test_without_the_override_such_stamps_are_refused_with_it(tmp_path):
    columns = {"Time [ms]": T, "q [rad]": Q, "dq [rad/s]": V, "tau [Nm]": V}
    case(tmp_path, columns)
    text = (
        (tmp_path / "a.yaml")
        .read_text()
        .replace("unit: s\n", "unit: ms\n")
        .replace("override: true", "override: false")
    )
    with pytest.raises(
        MachineError, match=r"dq.*1000 times as far.*limit 0\.9 to 1\.1.*time: \{unit: s, override: true\}"
    ):
        case(tmp_path, columns, text)


def test_a_speed_in_another_unit_is_no_clock_and_is_left_out_of_a_draft(tmp_path):
    found, _ = case(tmp_path, {"t": T, "q [rad]": Q, "dq [rad/s]": 2.5 * V, "tau [Nm]": V})
    assert found.period == pytest.approx(0.002)
    assert load_description(tmp_path / "a.yaml").axes[0].signals.velocity is None


def magnitude(sign=1.0):
    """What a drive reports whose current has no sign: 2 N m dry, 1 N m s viscous."""
    return np.abs(2.0 * np.sign(V) + V) * sign


def test_a_magnitude_of_an_effort_takes_the_sign_of_the_motion_and_it_is_said(tmp_path):
    run, notes = case(tmp_path, {"t": T, "q [rad]": Q, "tau [Nm]": magnitude()})
    effort = run.signals["axis"]["effort"]
    assert np.mean(effort * V > 0.0) > 0.99 and effort.min() < -2.0
    assert any("has the sign of the motion, because it is never below zero" in note for note in notes)


def test_a_weight_that_keeps_an_effort_above_zero_is_no_magnitude(tmp_path):
    run, notes = case(tmp_path, {"t": T, "q [rad]": Q, "tau [Nm]": 5.0 + 1.0 * np.sign(V) + V})
    assert run.signals["axis"]["effort"].min() > 0.0 and not any("sign" in note for note in notes)


def test_a_sign_in_a_column_of_its_own(tmp_path):
    data = {"i": np.array([1.0, 2.0, 3.0]), "dir": np.array([1.0, -1.0, 0.0])}
    assert pick(Column(column="i", unit="A", signed_by="dir"), data, "a").tolist() == [1.0, -2.0, 0.0]


def test_a_duty_called_load_is_an_effort_and_an_encoder_called_load_is_none(tmp_path):
    duty = 40.0 * np.sign(V)
    write(tmp_path, "t,position,load", T, Q, duty)
    assert "effort:\n      column: load" in draft(tmp_path / "a.csv").text
    write(tmp_path, "t,position,load", T, Q, Q)
    assert "load:\n      column: load" in draft(tmp_path / "a.csv").text


def test_a_doubtful_unit_and_a_share_are_commands(tmp_path):
    columns = np.column_stack([T, Q, V, V])
    np.savetxt(
        tmp_path / "a.csv",
        columns,
        delimiter=",",
        header="t,position,front command [amps?],back command [-1:1]",
        comments="",
    )
    found = draft(tmp_path / "a.csv").text
    assert "command:\n      column: front command [amps?]\n      unit: A" in found and "reference" not in found


def test_a_matrix_that_nobody_reads_is_named(tmp_path):
    np.savez(tmp_path / "a.npz", t=T, position=Q, frames=np.random.default_rng(0).normal(size=(len(T), 40)))
    assert any("not used: frames" in guess for guess in draft(tmp_path / "a.npz").guesses)
