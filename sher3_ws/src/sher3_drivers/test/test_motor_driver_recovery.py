"""Recovery from stops and faults, the report, and the two state machines held against each other."""

import itertools

import pytest
from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.bus.frame import iter_frames
from sher3_drivers.canopen.cia402 import TRANSITIONS, Controlword, DriveState, transition
from sher3_drivers.canopen.objects import RPDO_BASE
from sher3_drivers.drive.report import driver_report
from sher3_drivers.errors import CommandRefused
from sher3_drivers.mock import drive as mock_drive
from sher3_drivers.watches.trips import Trip

ROBOT = load_robot()
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
_numbers = itertools.count()


def test_reset_needs_a_stop_and_enabling_needs_a_reset(rig):
    with pytest.raises(CommandRefused, match="nothing is stopped"):
        rig.driver.reset()
    rig.driver.stop_for(Trip(Reason.SUPERVISOR_FAULT, "test"))
    with pytest.raises(CommandRefused, match="after a stop"):
        rig.driver.enable()
    rig.tick()
    rig.driver.reset()
    with pytest.raises(CommandRefused, match="nothing is stopped"):
        rig.driver.reset()
    for _ in range(5):
        rig.tick(SLOW)
    assert rig.states() == {"SWITCH_ON_DISABLED"}
    rig.enable()
    rig.tick(SLOW)


def test_a_fault_that_nothing_announced_is_a_stop_at_rest_too(make_rig):
    rig = make_rig()
    rig.driver.configure()
    rig.mock.drives["delta_3"].state = mock_drive.FAULT
    rig.tick()
    assert rig.driver.stop.code is Reason.DRIVE_FAULT and "delta_3" in rig.driver.stop.reason
    with pytest.raises(CommandRefused, match="delta_3"):
        rig.driver.enable()
    rig.driver.reset()
    rig.tick()
    rig.tick()
    rig.enable()


def test_a_fault_is_reset_by_one_rising_edge_and_leaves_the_drive_disabled(rig):
    words = []
    drive = rig.mock.drives["delta_2"]

    def listen(channel, frames, now):
        words.extend(data[0] for can_id, data in iter_frames(frames) if can_id == RPDO_BASE + drive.node_id)
        return frames

    rig.mock.tamper_received = listen
    drive.fault(0x8611)
    for _ in range(10):
        rig.tick(SLOW)
    assert drive.state == mock_drive.FAULT and 0x80 not in words
    rig.driver.reset()
    for _ in range(10):
        rig.tick(SLOW)
    assert words.count(0x80) == 1
    assert rig.states() == {"SWITCH_ON_DISABLED"} and rig.driver.stop.reason is None
    rig.enable()


def test_a_fault_after_a_recovery_needs_a_reset_of_its_own(rig):
    drive = rig.mock.drives["roll"]
    drive.fault(0x2310)
    for _ in range(10):
        rig.tick()
    rig.driver.reset()
    for _ in range(10):
        rig.tick()
    rig.enable()
    drive.fault(0x2310)
    for _ in range(20):
        rig.tick()
    assert drive.state == mock_drive.FAULT and rig.driver.stop.reason.startswith("roll")


def test_the_first_reason_is_kept_and_later_ones_counted(rig):
    rig.mock.drives["roll"].fault(0x2310)
    rig.tick(SLOW)
    rig.mock.drives["tilt"].fault(0x4310)
    rig.tick(SLOW)
    assert "roll" in rig.driver.stop.reason and rig.driver.stop.later > 0
    assert [e.code for e in rig.driver.session.drives[4].emergencies] == [0x4310]


_STATES = {
    DriveState.NOT_READY_TO_SWITCH_ON: mock_drive.NOT_READY,
    DriveState.SWITCH_ON_DISABLED: mock_drive.SWITCH_ON_DISABLED,
    DriveState.READY_TO_SWITCH_ON: mock_drive.READY,
    DriveState.SWITCHED_ON: mock_drive.SWITCHED_ON,
    DriveState.OPERATION_ENABLED: mock_drive.ENABLED,
    DriveState.QUICK_STOP_ACTIVE: mock_drive.QUICK_STOP,
    DriveState.FAULT_REACTION_ACTIVE: mock_drive.FAULT_REACTION,
    DriveState.FAULT: mock_drive.FAULT,
}


@pytest.mark.parametrize(("state", "command"), list(itertools.product(DriveState, Controlword)))
def test_both_sides_of_the_wire_have_the_same_state_machine(state, command):
    """All pairs but transition 16, which drives have and the host's table leaves out."""
    after = mock_drive.next_state(_STATES[state], command.value, previous=0)
    if (state, command) == (DriveState.QUICK_STOP_ACTIVE, Controlword.ENABLE_OPERATION):
        assert after == mock_drive.ENABLED and (state, command) not in TRANSITIONS
    else:
        assert after == _STATES[transition(state, command)]


@pytest.mark.parametrize("previous", [0x80, 0x8F])
def test_a_level_of_the_reset_bit_resets_nothing(previous):
    assert mock_drive.next_state(mock_drive.FAULT, 0x80, previous) == mock_drive.FAULT


def test_the_report_names_emergencies_until_they_are_reset(rig):
    rig.tick(SLOW)
    assert driver_report(rig.driver)[:2] == (0, "enabled")
    rig.mock.drives["roll"].fault(0x4310)
    for _ in range(10):
        rig.tick()
    level, message, values = driver_report(rig.driver)
    assert level == 2 and "over-temperature" in message
    assert "0x4310" in dict(values)["roll.emergency"] and dict(values)["roll.state"] == "FAULT"
    rig.driver.reset()
    for _ in range(5):
        rig.tick()
    assert "roll.emergency" not in dict(driver_report(rig.driver)[2])


def test_the_report_warns_of_frames_that_came_twice(rig):
    rig.mock.tamper_frames = lambda channel, frames, now: frames + frames[:16]
    rig.tick(SLOW)
    assert driver_report(rig.driver)[0] == 1 and dict(driver_report(rig.driver)[2])["duplicate_tpdos"] == "2"
