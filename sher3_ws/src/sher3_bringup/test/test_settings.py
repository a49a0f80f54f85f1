"""Every wrong option is refused before anything starts, with value, limit and remedy."""

import json

import pytest
from sher3_bringup.errors import ConfigurationError
from sher3_bringup.settings.patience import BENCH, CONTROL, DRIVES, drives_in, usual
from sher3_bringup.settings.run_settings import NODES, checked, parse_processes
from sher3_cli.root import make_app
from sher3_common import Sher3Error
from sher3_control.settings import ControlSettings, MotionSettings
from sher3_description import load_robot
from sher3_drivers.errors import DriverSettingsError
from sher3_drivers.settings import default_settings
from sher3_faults.budget import BudgetExceeded
from typer.testing import CliRunner


def test_the_default_run_is_every_node_in_its_own_process():
    settings = checked(processes=parse_processes(None, mock=True, record=False))
    assert settings.processes == tuple((name,) for name in NODES if name not in ("recorder", "gap_monitor"))
    assert settings.robot().control_period == 0.002
    assert all(channel.link.startswith("local:sher3-0/") for channel in settings.drives().channels)


def test_processes_can_be_joined():
    assert parse_processes("force_sensor+pedal, admittance", mock=True, record=False) == (
        ("force_sensor", "pedal"),
        ("admittance",),
    )


def test_the_loop_can_be_one_process_and_the_supervisor_never_is_part_of_it():
    processes = parse_processes(None, mock=True, record=True, layout="composed")
    assert processes[0] == ("force_sensor", "pedal", "admittance", "kinematics", "motor_driver")
    assert all(len(process) == 1 for process in processes[1:])
    assert {name for process in processes for name in process} == {*NODES} - {"gap_monitor"}
    assert parse_processes(None, mock=False, record=False, layout="composed")[1:] == (("supervisor",),)


def test_the_rate_sets_period_and_channels():
    """A kilohertz does not fit on the channels of 500 Hz; the layout follows."""
    slow, fast = checked(rate=500.0), checked(rate=1000.0)
    assert fast.robot().control_period == 0.001 == fast.drives().period
    assert len(fast.drives().channels) > len(slow.drives().channels)
    assert all(budget.load < 0.9 for budget in fast.drives().budgets())


def test_patience_lengthens_time_limits_and_nothing_else():
    """Every limit that differs is a longer time; strict is what drivers and control declare themselves."""
    strict, patient = checked(), checked(patience="patient")
    assert strict.control() == ControlSettings.from_robot(strict.robot(), {"motion": {"regime": "bench"}})
    assert strict.drives().host_heartbeat_limit == 0.027
    for part, names in CONTROL.items():
        before, after = (getattr(run.control(), part).model_dump() for run in (strict, patient))
        assert {name for name in before if before[name] != after[name]} == set(names)
        assert all(after[name] > before[name] for name in names)
    before, after = strict.drives().model_dump(), patient.drives().model_dump()
    assert {name for name in before if before[name] != after[name]} == set(DRIVES)
    assert all(after[name] > before[name] for name in DRIVES)


@pytest.mark.parametrize(
    ("mock", "regime", "realtime", "expected"),
    [
        (True, "", 0, "patient"),
        (True, "bench", 0, "patient"),
        (True, "", 40, "strict"),
        (True, "near_tissue", 0, "strict"),
        (True, "free", 0, "strict"),
        (False, "", 0, "strict"),
        (False, "bench", 0, "strict"),
    ],
)
def test_limits_are_patient_only_where_nothing_can_be_hurt_and_no_hold_up_is_bounded(mock, regime, realtime, expected):
    assert usual(mock, regime, realtime) == expected


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate": 5000.0}, "rate: .*less than or equal to 1000"),
        ({"rate": float("nan")}, "rate"),
        ({"processes": (("plant", "motor_driver"),)}, "wait for each other"),
        ({"processes": (("motor_driver", "supervisor"),)}, "a process of its own"),
        ({"processes": (("kinematics", "gap_monitor"),)}, "hold up the nodes of the loop"),
        ({"processes": (("pedals",),)}, "unknown node pedals; known: plant"),
        ({"processes": (("pedal",), ("pedal",))}, "named twice"),
        ({"mock": False, "links": ("socketcan:can0", "socketcan:can1"), "processes": (("plant",),)}, "for mocks only"),
        ({"mock": False, "effects": "e.yaml"}, "a real robot has none"),
        ({"mock": False}, "needs --can"),
        ({"mock": False, "links": ("socketcan:can0", "socketcan:can1"), "processes": (("pedal",),)}, "--pedal-device"),
        ({"processes": (("recorder",),)}, "needs --record"),
        ({"mock": False, "patience": "patient", "links": ("a", "b")}, "patient time limits are for mocks only"),
        ({"patience": "endless"}, "patience"),
        ({"duration": -1.0}, "duration"),
        ({"domain": 232}, "domain"),
        ({"surprise": 1}, "surprise"),
    ],
)
def test_contradictions_are_named(options, message):
    with pytest.raises(ConfigurationError, match=message) as caught:
        checked(**options)
    assert caught.value.remedy and caught.value.exit_code == 2


def test_a_channel_too_few_for_the_rate():
    with pytest.raises(Sher3Error, match="links"):
        checked(rate=1000.0, links=("local:a", "local:b"))


def test_name_plates_reach_the_driver_and_a_drive_that_does_not_exist_is_refused(tmp_path):
    path = tmp_path / "drives.yaml"
    text = "schema: sher3.drives/1\ndrives: {ROLL: {vendor: 1, product: 2, serial: 3}}\n"
    path.write_text(text.replace("ROLL", "roll"))
    (plate,) = checked(drives_path=path, processes=parse_processes(None, True, False)).drives().identities
    assert (plate.drive, plate.serial) == ("roll", 3)
    path.write_text(text)
    with pytest.raises(DriverSettingsError, match="identities name the drives"):
        checked(drives_path=path)


def test_a_robot_file_that_is_not_there(tmp_path):
    with pytest.raises(Sher3Error, match="no such file"):
        checked(robot_path=tmp_path / "robot.yaml")


REAL = {"mock": False, "links": ("socketcan:can0", "socketcan:can1"), "processes": (("motor_driver",), ("supervisor",))}


def test_settings_beyond_the_travel_budget_are_refused_before_anything_starts():
    with pytest.raises(BudgetExceeded, match="--near-speed"):
        checked(**REAL, rate=200.0)
    slow = checked(**REAL, rate=200.0, near_speed=4e-4, free_speed=4e-3)
    assert slow.control().motion.near_turning == pytest.approx(0.024)
    with pytest.raises(BudgetExceeded, match="travel budget"):
        checked(patience="patient", regime="near_tissue")


def test_the_bench_is_the_default_of_mocks_alone_and_has_limits_of_its_own():
    assert checked().control().motion.regime == "bench"
    assert checked(**REAL).control().motion.regime == "free"
    strict, bench = (checked(**REAL, regime=regime).drives().model_dump() for regime in ("free", "bench"))
    changed = {name for name in strict if bench[name] != strict[name]}
    assert changed == {*BENCH, "regime"} and all(bench[name] > strict[name] for name in BENCH)
    assert checked(regime="free").drives().encoder_distance == strict["encoder_distance"]
    robot, drives = load_robot(), default_settings()
    near, free = (drives_in(robot, MotionSettings(regime=name), drives) for name in ("near_tissue", "free"))
    assert near.model_copy(update={"regime": "free"}) == free
    assert free.model_copy(update={"regime": drives.regime, "caps": ()}) == drives
    caps = {row.regime: row.caps for row in near.caps}
    assert caps["near_tissue"] == pytest.approx((2e-3, 2e-3, 2e-3, 0.03, 0.9e-3))
    assert caps["free"] == pytest.approx((12.2e-3, 12.2e-3, 12.2e-3, 0.3, 9e-3))


def test_the_budget_is_printed_and_its_exit_code_says_whether_it_is_kept():
    kept = CliRunner().invoke(make_app("safety"), ["safety", "budget", "--json"])
    assert kept.exit_code == 0
    rows = json.loads(kept.output)["rows"]
    assert max(row["travel"] for row in rows if row["regime"] == "near_tissue") <= 25e-6
    assert {row["regime"] for row in rows} == {"near_tissue", "free", "bench"}
    assert CliRunner().invoke(make_app("safety"), ["safety", "budget", "--patient"]).exit_code == 1
