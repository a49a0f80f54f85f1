"""A recovery over channels that lose frames, and of drives that restarted; 2 ms periods, transition limit 0.5 s."""

import itertools

import pytest
from sher3_common.reasons import Reason
from sher3_drivers.bus.frame import iter_frames, pack_frame
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.cia402 import DriveState, Goal
from sher3_drivers.drive.session import DriveSession
from sher3_drivers.drive.supervisor_link import SupervisorLink
from sher3_drivers.errors import CommandRefused
from sher3_drivers.mock import drive as mock_drive
from sher3_drivers.watches.drives import DriveHealth

FAULT, OFF, ENABLED = 0x08, 0x40, 0x27
MS = 1_000_000


@pytest.fixture
def link(rig):
    """The driver's ear for the supervisor, which says ENABLED."""
    link = SupervisorLink(rig.driver)
    link.obey("ENABLED")
    return link


def lose_resets(rig, number):
    """Let the drive delta_1 miss the first `number` fault resets; return the count of those it was sent."""
    sent = itertools.count()
    rig.sent = 0

    def tamper(channel, frames, now):
        kept = []
        for can_id, data in iter_frames(frames):
            is_reset = can_id == od.RPDO_BASE + 1 and data[0] == 0x80
            rig.sent += is_reset
            if not (is_reset and next(sent) < number):
                kept.append(pack_frame(can_id, data))
        return b"".join(kept)

    rig.mock.tamper_received = tamper


@pytest.mark.parametrize("lost", [0, 1, 7])
def test_a_fault_reset_is_held_until_the_drive_has_left_fault(rig, link, lost):
    lose_resets(rig, lost)
    rig.mock.drives["delta_1"].fault(0x2310)
    for _ in range(10):
        rig.tick()
    link.obey("FAULT")
    link.obey("DISABLED")
    rig.tick()
    rig.tick()
    link.obey("ENABLED")  # soon: no drive gets power before the last one has left FAULT
    for _ in range(lost - 1):
        rig.tick()
        assert mock_drive.ENABLED not in {drive.state for drive in rig.mock.drives.values()}
    for _ in range(12):
        rig.tick()
    assert rig.driver.stop.first is None and link.refused is None
    assert rig.driver.enabled, rig.states()
    assert rig.sent == lost + 1


def test_a_reset_without_effect_is_given_up_after_the_transition_limit(rig, link):
    """0.5 s are 250 periods; drives are looked at every 5 ms, which are 3 periods."""
    lose_resets(rig, 10**6)
    rig.mock.drives["delta_1"].fault(0x2310)
    for _ in range(10):
        rig.tick()
    link.obey("FAULT")
    link.obey("DISABLED")
    for _ in range(249):
        rig.tick()
    assert rig.driver.stop.first is None
    for _ in range(6):
        rig.tick()
    assert rig.driver.stop.code is Reason.DRIVE_STUCK and rig.driver.stop.first.text.startswith(
        "delta_1: stays in FAULT"
    )


def test_only_a_recovery_resets(rig, link):
    """DISABLED after ENABLED takes the power off and leaves the fault, which is a stop with its reason."""
    lose_resets(rig, 0)
    rig.mock.drives["delta_1"].fault(0x2310)
    for _ in range(10):
        rig.tick()
    link.obey("DISABLED")
    for _ in range(10):
        rig.tick()
    assert rig.sent == 0 and rig.driver.stop.code is Reason.DRIVE_EMERGENCY


def test_enabled_without_its_drives_is_a_stop_and_a_refusal_ends_with_its_cause(rig, link):
    link.obey("DISABLED")
    rig.tick()
    rig.driver.session.drives[0].on_statusword(FAULT, rig.now)
    link.obey("ENABLED")
    assert rig.driver.stop.code is Reason.DRIVE_FAULT and "reset first" in link.refused
    link.obey("FAULT")
    assert link.refused is None


@pytest.mark.parametrize("name", ["delta_1", "tilt"])
def test_a_drive_that_restarted_is_configured_again_by_a_recovery(rig, link, name):
    """After its restart the mock holds factory values: PDOs that are switched off, no heartbeat."""
    drive = rig.mock.drives[name]
    for _ in range(60):
        rig.tick([0.0] * 5)  # a heartbeat of each drive: every 0.1 s
    drive.receive(od.NMT_ID, bytes([0x81, drive.node_id]), rig.now)
    assert not drive.node.operational
    for _ in range(20):
        rig.tick()
    assert rig.driver.stop.code is Reason.DRIVE_RESTARTED
    link.obey("FAULT")
    link.obey("DISABLED")
    for _ in range(5):
        rig.tick()
    assert drive.node.operational and rig.driver.stop.first is None
    assert drive.node.values[od.HOST_HEARTBEAT] != drive.node.factory[od.HOST_HEARTBEAT]
    link.obey("ENABLED")
    for _ in range(10):
        rig.tick()
    assert rig.driver.enabled


def test_a_drive_that_stays_away_stops_the_recovery_too(rig, link):
    drive = rig.mock.drives["roll"]
    drive.powered = False
    for _ in range(20):
        rig.tick()
    link.obey("FAULT")
    link.obey("DISABLED")
    for _ in range(5):
        rig.tick()
    assert rig.driver.stop.code is Reason.DRIVE_RESTARTED and "roll" in rig.driver.stop.reason
    drive.powered = True
    link.obey("FAULT")
    link.obey("DISABLED")
    for _ in range(5):
        rig.tick()
    assert rig.driver.stop.first is None and drive.node.operational


def test_the_others_lose_their_power_before_a_drive_is_set_up():
    session = DriveSession([DriveHealth("a"), DriveHealth("b")])
    session.stop_for(session.drives[0].faulty(), 0)
    list(session.judge([ENABLED, ENABLED], frozenset(), 10, 0))
    session.drives[0].heard_at = 0
    assert session.drives[0].on_heartbeat(bytes([0]), 1).reason is Reason.DRIVE_RESTARTED
    session.reset(2 * MS)
    assert session.setup_due and not session.may_set_up and session.heading is Goal.DISABLED
    list(session.judge([ENABLED, OFF], frozenset(), 10, 4 * MS))
    assert session.may_set_up
    session.set_up(6 * MS)
    assert not session.setup_due and session.drives[0].state is None


def test_a_drive_in_fault_is_enabled_by_nobody_outside_a_recovery():
    session = DriveSession([DriveHealth("a", state=DriveState.FAULT)])
    with pytest.raises(CommandRefused, match="reset first"):
        session.enable(0)
    session.reset(0)
    assert session.enable(0) and session.heading is Goal.DISABLED


def test_a_fault_at_rest_is_a_stop_even_if_its_emergency_message_was_lost():
    session = DriveSession([DriveHealth("a"), DriveHealth("b")])
    trips = list(session.judge([OFF, FAULT], frozenset(), 10, 0))
    assert [(trip.reason, trip.text[:2]) for trip in trips] == [(Reason.DRIVE_FAULT, "b:")]
