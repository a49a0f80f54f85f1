"""Units, clocks and holes of the records of a chain of axes."""

import numpy as np
import pytest
from sher3_chain.joint.parts import parts_of_record
from sher3_chain.joint.record import axes_run
from sher3_chain.joint.units import check_units
from sher3_machines import MachineError
from slides import axis_of, columns, described

SERVO = {"signals": columns("position", "reference"), "command_law": {"kind": "position"}}


def tables(n=200, **more):
    t = 0.01 * np.arange(n)
    return {"t": t, "position": 0.1 * t, "reference": 0.1 * t, **more}


def test_an_even_record_is_taken_as_it_is():
    run = axes_run("run", tables(), described(**SERVO))
    assert run.period == pytest.approx(0.01) and run.notes == []
    assert run.signals["slide"]["position"] == pytest.approx(0.1 * 0.01 * np.arange(200))


def test_a_late_stamp_is_moved_to_the_grid_and_said():
    """One stamp is 0.4 periods late: the line is read 0.4 periods earlier there."""
    late = tables()
    late["t"] = late["t"].copy()
    late["t"][50] += 0.004
    late["position"] = late["reference"] = 0.1 * late["t"]
    run = axes_run("run", late, described(**SERVO))
    assert run.signals["slide"]["position"] == pytest.approx(0.1 * 0.01 * np.arange(200), abs=1e-12)
    assert "off the grid by up to 0.4 periods" in run.notes[0]


@pytest.mark.parametrize("late", [0.0, 0.6, 4.0, 8.0])
def test_a_stretch_that_was_polled_again_is_no_hole_though_a_row_of_it_is_late(late):
    """Of 400 rows every fourth is polled twice, and one for sixteen rows, of which one comes up to 8 periods late."""
    place = np.sin(0.05 * np.arange(400.0))
    read = np.arange(400) - (np.arange(400) % 4 == 3)
    read[201:217] = 200
    t = 0.01 * np.arange(400.0)
    t[210:] += 0.01 * late
    again = {"t": t, "position": place[read], "reference": place[read]}
    run = axes_run("run", again, described(**SERVO))
    assert run.notes[0].endswith("polled twice; left out")
    at = 0.01 * np.arange(len(run.signals["slide"]["position"]))
    assert run.signals["slide"]["position"] == pytest.approx(np.interp(at, t, place), abs=0.08)


def test_signals_on_clocks_of_their_own_meet_where_they_overlap():
    machine = described(
        **{**SERVO, "signals": {k: {"column": f"{k}/x", "unit": "m"} for k in ("position", "reference")}}
    )
    t = 0.01 * np.arange(300)
    found = {"position/t": t, "position/x": t, "reference/t": t + 0.5, "reference/x": 2.0 * (t + 0.5)}
    signals = axes_run("run", found, machine).signals["slide"]
    assert len(signals["position"]) == 250
    assert signals["position"][0] == pytest.approx(0.5) and signals["reference"][0] == pytest.approx(1.0)


@pytest.mark.parametrize(("far", "refused"), [(0.0, False), (0.5, True)])
def test_a_monitor_that_posts_changes_alone_has_no_hole_while_nothing_moves(far, refused):
    """Half a minute without a reading: the slide stood, or it went on by half a metre."""
    t = 0.01 * np.arange(300)
    stamps, place = t + 30.0 * (t >= 1.5), 0.2 * np.cos(4.0 * np.pi * t / 3.0) + far * (t >= 1.5)
    machine = described(
        **{**SERVO, "signals": {k: {"column": f"{k}/x", "unit": "m"} for k in ("position", "reference")}}
    )
    posted = {f"{k}/{n}": x for k in ("position", "reference") for n, x in {"t": stamps, "x": place}.items()}
    if refused:
        with pytest.raises(MachineError, match="a hole of 30 s"):
            axes_run("run", posted, machine)
        return
    found = axes_run("run", posted, machine).signals["slide"]["position"]
    assert len(found) == pytest.approx(3300, abs=2) and found[200:3100] == pytest.approx(0.2, abs=1e-3)


def test_a_rate_stands_for_stamps():
    machine = described(**SERVO).model_copy(
        update={"time": described().time.model_copy(update={"column": None, "rate": 50.0})}
    )
    assert axes_run("run", tables(), machine).period == pytest.approx(0.02)
    with pytest.raises(MachineError, match="differ in length"):
        axes_run("run", {**tables(), "reference": np.zeros(150)}, machine)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"n": 15}, "too short"),
        ({"reference": np.zeros(150)}, "time and signal differ in length"),
    ],
)
def test_a_record_that_cannot_be_used_is_named(change, words):
    with pytest.raises(MachineError, match=words):
        axes_run("run", tables(**change), described(**SERVO))


def test_positions_outside_the_stated_range_are_a_wrong_unit():
    """A range of 0.3 m: 200 is 200 mm; 0.32 is inside what rounding of the range allows."""
    axis = axis_of(range=(0.0, 0.3))
    with pytest.raises(MachineError, match="likely mm recorded as m"):
        check_units(axis, {"position": np.array([0.0, 200.0])}, "run")
    with pytest.raises(MachineError, match="leaves the range of the axis"):
        check_units(axis, {"position": np.array([0.0, 0.4])}, "run")
    check_units(axis, {"position": np.array([0.0, 0.32])}, "run")


def test_a_reference_in_another_unit_is_named():
    found = {"position": 0.1 * np.linspace(0.0, 1.0, 100), "reference": 100.0 * np.linspace(0.0, 1.0, 100)}
    with pytest.raises(MachineError, match=r"slide.reference: likely mm recorded as m"):
        check_units(axis_of(range=(0.0, 1.0)), found, "run")


@pytest.mark.parametrize("stated", [{"unit": "count", "factor": 1e-3}, {"unit": "deg"}, {"unit": "rev"}])
def test_a_motor_that_counts_may_make_many_turns(stated):
    """117 rad in counts or degrees are no slip; 117 that were stated as rad may be."""
    found = {"position": np.linspace(0.0, 117.0, 50)}
    signals = {"position": {"column": "q", **stated}, "effort": {"column": "i", "unit": "A"}}
    check_units(axis_of(motion="rotary", signals=signals), found, "run")
    signals["position"] = {"column": "q", "unit": "rad"}
    with pytest.raises(MachineError, match="likely deg recorded as rad; value 117"):
        check_units(axis_of(motion="rotary", signals=signals), found, "run")


def test_a_motor_whose_field_starts_again_at_25_radians_may_make_many_turns():
    """Of 100 rad in a field of +-12.5 nothing lies beyond what an angle may be; 100 rad as recorded are degrees."""
    path = 50.0 * np.sin(np.arange(0.0, 12.0, 0.01))
    field = (path + 12.5) % 25.0 - 12.5
    signals = {k: {"column": k, "unit": "rad"} for k in ("position", "reference")}
    motor = described(motion="rotary", signals=signals, command_law={"kind": "position"}, mass=None)
    table = {"t": 0.01 * np.arange(len(path)), "position": field, "reference": field}
    run = axes_run("run", table, motor)
    assert run.signals["slide"]["position"] == pytest.approx(path, abs=1e-9)
    assert "within 25 rad; joined" in run.notes[0]
    with pytest.raises(MachineError, match="deg recorded as rad"):
        axes_run("run", {**table, "position": path, "reference": path}, motor)


def test_an_effort_in_a_field_without_a_sign_is_signed_and_said():
    """A current of -3 that a drive logs as 65533."""
    current = np.round(40.0 * np.sin(0.1 * np.arange(200)))
    axis = {"signals": columns("position", "effort"), "command_law": {"kind": "force"}, "mass": 1.0}
    run = axes_run("run", tables(effort=np.where(current < 0.0, current + 65536.0, current)), described(**axis))
    assert run.signals["slide"]["effort"] == pytest.approx(current)
    assert "has 65535 for -1, as a field of 16 bits has; signed" in run.notes[0]


@pytest.mark.parametrize("table", ["", "/states/slide/"])
def test_columns_on_one_clock_are_cut_at_its_hole_whatever_their_names(table):
    """A log of one table has strokes in its names: `/joint_states/arm/position`."""
    t = 0.01 * np.arange(400)
    t[200:] += 1.0
    machine = described(
        **{**SERVO, "signals": {k: {"column": f"{table}{k}", "unit": "m"} for k in ("position", "reference")}}
    )
    parts, note = parts_of_record("run", {"t": t, **{f"{table}{k}": t for k in ("position", "reference")}}, machine)
    assert [len(part["t"]) for part in parts.values()] == [200, 200] and "2 parts" in note
    other = described(
        **{**SERVO, "signals": {k: {"column": f"/{k}/x", "unit": "m"} for k in ("position", "reference")}}
    )
    assert len(parts_of_record("run", {"t": t, "/position/x": t, "/reference/x": t}, other)[0]) == 2


def test_what_is_posted_as_it_changes_stays_until_then():
    """Four readings in 400 rows: the record begins with the first one, and the last one holds to its end."""
    posted = np.full(400, np.nan)
    posted[[50, 100, 220, 300]] = [1.0, -1.0, 2.0, 0.0]
    force = {"signals": columns("position", "effort"), "command_law": {"kind": "force"}, "mass": 1.0}
    run = axes_run(
        "run", {"t": 0.01 * np.arange(400), "position": 1e-4 * np.arange(400.0), "effort": posted}, described(**force)
    )
    effort = run.signals["slide"]["effort"]
    assert len(effort) == 350 and "posted 4 times" in run.notes[0]
    told = np.repeat([1.0, -1.0, 2.0, 0.0], [50, 120, 80, 100])
    assert np.mean(np.abs(effort - told) < 1e-6) > 0.98  # but for steps that rounding puts a row later
