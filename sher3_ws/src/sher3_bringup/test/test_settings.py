"""Every wrong option is refused before anything starts, with value, limit and remedy."""

import pytest
from sher3_bringup.errors import ConfigurationError
from sher3_bringup.patience import CONTROL, DRIVES
from sher3_bringup.settings import NODES, checked, parse_processes
from sher3_control.settings import ControlSettings
from sher3_description import Sher3Error


def test_the_default_run_is_every_node_in_its_own_process():
    settings = checked(processes=parse_processes(None, mock=True, record=False))
    assert settings.processes == tuple((name,) for name in NODES if name not in ("recorder", "gap_monitor"))
    assert settings.robot().control_period == 0.002
    assert all(channel.link.startswith("local:sher3-0-") for channel in settings.drives().channels)


def test_processes_can_be_joined():
    assert parse_processes("force_sensor+pedal, admittance", mock=True, record=False) == (
        ("force_sensor", "pedal"),
        ("admittance",),
    )


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
    assert strict.drives().host_heartbeat_limit == 0.03
    for part, names in CONTROL.items():
        before, after = (getattr(run.control(), part).model_dump() for run in (strict, patient))
        assert {name for name in before if before[name] != after[name]} == set(names)
        assert all(after[name] > before[name] for name in names)
    before, after = strict.drives().model_dump(), patient.drives().model_dump()
    assert {name for name in before if before[name] != after[name]} == set(DRIVES)
    assert all(after[name] > before[name] for name in DRIVES)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"rate": 5000.0}, "rate: .*less than or equal to 1000"),
        ({"rate": float("nan")}, "rate"),
        ({"processes": (("plant", "motor_driver"),)}, "wait for each other"),
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


def test_a_robot_file_that_is_not_there(tmp_path):
    with pytest.raises(Sher3Error, match="no such file"):
        checked(robot_path=tmp_path / "robot.yaml")
