"""End-to-end protection: reports of another tick or drive, garbled ones, second drives and hosts; garbled commands."""

import pytest
from sher3_common.reasons import Reason
from sher3_drivers.bus.frame import FRAME_SIZE, iter_frames, pack_frame
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.canopen.protection import COUNTS, check_of, count_after, count_before

SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
TPDO1 = od.TPDO_BASES[0] + 1
BACK_ENDS = ["cable"]
"""One back end is enough: what is tested here does not depend on the link."""
pytestmark = pytest.mark.parametrize("make_rig", BACK_ENDS, indirect=True)


def ticks_until_stop(rig, most=12, velocity=SLOW):
    """Return the number of ticks until the driver has stopped, None when it does not."""
    for k in range(most):
        rig.tick(velocity)
        if rig.driver.stop.first is not None:
            return k + 1
    return None


def on_reports(rig, change):
    """Let `change` act on (can_id, data) of every frame of channel 0; it returns the frames that pass."""
    rig.mock.tamper_frames = lambda channel, frames, now: (
        frames
        if channel
        else b"".join(pack_frame(*new) for f in iter_frames(frames) for new in change(f.can_id, f.data))
    )


def test_the_counter_goes_round_and_knows_its_past(make_rig):
    assert [count_after(0), count_after(1), count_after(COUNTS)] == [1, 2, 1]
    assert [count_before(5, 2), count_before(1, 1), count_before(2, 3)] == [3, COUNTS, 239]


def test_a_check_belongs_to_one_drive_and_one_sync(make_rig):
    data, seen = bytes(16), set()
    for node in range(1, 6):
        seen |= {check_of(data, node, counter) for counter in range(1, COUNTS + 1)}
    assert len(seen) == 5 * COUNTS


def late(age, channels):
    """Return what holds the reports of some channels back for so many ticks."""
    waiting = {channel: [b""] * age for channel in channels}

    def delay(channel, frames, now):
        if channel not in waiting:
            return frames
        waiting[channel].append(frames)
        return waiting[channel].pop(0)

    return delay


@pytest.mark.parametrize(("age", "reason"), [(1, Reason.FEEDBACK_STALE), (3, Reason.DRIVE_SILENT)])
def test_drives_that_are_late_alone_are_found_sooner(make_rig, age, reason):
    """While others are heard this computer is not late: a report that stays away counts as one that is not believed."""
    rig = make_rig()
    rig.enable()
    rig.tick(SLOW)
    rig.mock.tamper_frames = late(age, (0,))
    assert ticks_until_stop(rig) == rig.settings.report_limit and rig.driver.stop.code is reason


@pytest.mark.parametrize("velocity", [SLOW, [0.0] * 5], ids=["moving", "at rest"])
@pytest.mark.parametrize("age", [1, 3])
def test_reports_of_an_older_tick_stop_the_robot_at_rest_too(rig, age, velocity):
    rig.tick(velocity)
    rig.mock.tamper_frames = late(age, (0, 1))
    assert ticks_until_stop(rig, velocity=velocity) == age + rig.settings.report_limit
    assert rig.driver.stop.code is Reason.FEEDBACK_STALE and f"{age} ticks old" in rig.driver.stop.reason


@pytest.mark.parametrize("velocity", [[0.001, 0.001, 0.001, 0.0, 0.0], [0.0] * 5], ids=["evenly", "at rest"])
def test_reports_of_two_axes_exchanged_stop_the_robot_however_they_move(rig, velocity):
    """Under a push along z all legs have the same command, so only the check tells one report from the other."""
    rig.tick(velocity)
    on_reports(rig, lambda can_id, data: [(can_id ^ 3 if can_id & 0x7F in (1, 2) else can_id, data)])
    assert ticks_until_stop(rig, velocity=velocity) == rig.settings.report_limit
    assert rig.driver.stop.code is Reason.FEEDBACK_SWAPPED and rig.driver.stop.first.axes == (0,)


def test_a_garbled_report_is_not_believed_and_three_stop_the_robot(rig):
    rig.tick(SLOW)
    on_reports(rig, lambda can_id, data: [(can_id, bytes([data[0] ^ 1]) + data[1:] if can_id == TPDO1 else data)])
    assert rig.tick(SLOW) is None and rig.driver.stop.first is None
    assert ticks_until_stop(rig) == rig.settings.report_limit - 1
    assert rig.driver.stop.code is Reason.FEEDBACK_GARBLED


def test_a_report_that_was_believed_again_is_forgiven(rig):
    rig.tick(SLOW)
    for _ in range(3):
        on_reports(rig, lambda can_id, data: [(can_id, bytes(8) if can_id == TPDO1 else data)])
        rig.tick(SLOW)
        rig.tick(SLOW)
        rig.mock.tamper_frames = None
        rig.tick(SLOW)
    assert rig.driver.stop.first is None


@pytest.mark.parametrize("first", [True, False])
def test_a_second_drive_with_the_same_node_id_stops_the_robot(rig, first):
    rig.tick(SLOW)

    def second(can_id, data):
        if can_id != TPDO1:
            return [(can_id, data)]
        other = bytes([data[0] ^ 1]) + data[1:]
        return [(can_id, other), (can_id, data)] if first else [(can_id, data), (can_id, other)]

    on_reports(rig, second)
    assert ticks_until_stop(rig) == rig.settings.report_limit
    assert rig.driver.stop.code in (Reason.DRIVE_TWICE, Reason.FEEDBACK_GARBLED)


def test_unprotected_reports_that_contradict_each_other_stop_the_robot(make_rig):
    rig = make_rig(protected=False)
    rig.enable()
    rig.tick(SLOW)
    on_reports(rig, lambda can_id, data: [(can_id, data), (can_id, bytes([data[0] ^ 1]) + data[1:])])
    assert ticks_until_stop(rig) == rig.settings.report_limit
    assert rig.driver.stop.code is Reason.DRIVE_TWICE


def test_the_same_report_twice_is_the_bus_at_work(rig):
    """A CAN controller may deliver a frame twice after an error in its last bit."""
    rig.tick(SLOW)
    on_reports(rig, lambda can_id, data: [(can_id, data)] * 2)
    assert ticks_until_stop(rig, 20) is None


def test_reports_on_the_channel_of_other_drives_stop_the_robot(rig):
    rig.tick(SLOW)
    rig.device_links[1].send_frames(pack_frame(TPDO1, bytes(8)))
    assert ticks_until_stop(rig, 2) is not None
    assert rig.driver.stop.code is Reason.DRIVE_TWICE and "delta_1" in rig.driver.stop.reason


@pytest.mark.parametrize(
    ("can_id", "data"),
    [(od.SYNC_ID, b""), (od.NMT_ID, b"\x80\x7f"), (od.HEARTBEAT_BASE + 127, b"\x05"), (od.RPDO_BASE + 2, bytes(8)),
     (od.SDO_REQUEST_BASE + 1, bytes(8))],
    ids=["SYNC", "NMT", "heartbeat", "RPDO", "SDO"],
)  # fmt: skip
@pytest.mark.parametrize("enabled", [True, False])
def test_another_host_is_heard_at_any_time(make_rig, can_id, data, enabled):
    rig = make_rig()
    rig.enable()
    if not enabled:
        rig.driver.disable()
        rig.tick()
    rig.tick()
    rig.device_links[0].send_frames(pack_frame(can_id, data))
    rig.tick()
    rig.tick()
    assert rig.driver.stop.code is Reason.OTHER_HOST and rig.driver.goal in (Goal.STOPPED, Goal.DISABLED)


def test_a_foreign_command_to_a_protected_drive_does_nothing(rig):
    rig.tick([0.0] * 5)
    drive = rig.mock.drives["delta_1"]
    drive.receive(od.RPDO_BASE + 1, b"\x0f\x00" + (10**9).to_bytes(4, "little") + b"\x12\x34", rig.now)
    assert rig.tick([0.0] * 5).velocity_demand == (0.0,) * 5


def test_commands_that_stay_garbled_make_the_drive_stop_by_itself(rig):
    rig.tick(SLOW)
    rig.mock.tamper_received = lambda channel, frames, now: b"".join(
        frame[:10] + bytes([frame[10] ^ 1]) + frame[11:] if frame[1] == 2 else frame
        for frame in (frames[k : k + FRAME_SIZE] for k in range(0, len(frames), FRAME_SIZE))
    )
    rig.tick(SLOW)
    for _ in range(4):
        demand = rig.tick(SLOW).velocity_demand
    assert all(abs(v) <= abs(w) + 1e-9 for v, w in zip(demand, SLOW, strict=True))
    assert any("fail their check" in str(e) for e in rig.driver.session.drives[0].emergencies)


def test_a_drive_without_commands_stops_by_itself_while_the_heart_beats(rig):
    """The event time of the RPDO (object 0x1400:05) is that of the host's heartbeat."""
    rig.tick(SLOW)
    rig.mock.tamper_received = lambda channel, frames, now: b"".join(
        frame for frame in (frames[k : k + FRAME_SIZE] for k in range(0, len(frames), FRAME_SIZE)) if frame[1] != 2
    )
    for _ in range(20):
        rig.tick(SLOW)
    assert any("RPDO timeout" in str(e) for d in rig.driver.session.drives for e in d.emergencies)
