"""What stops the robot, and that it stays stopped."""

import itertools
import struct

import pytest
from sher3_common.reasons import Reason
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.bus.condition import BusCondition, error_frame
from sher3_drivers.bus.frame import iter_frames, pack_frame, pack_frames
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.protection import check_of
from sher3_drivers.mock import drive as mock_drive

ROBOT = load_robot()
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
_numbers = itertools.count()


def stopped_by(rig, text):
    """Whether the robot came to rest with this reason and stays there, commands or not."""
    for _ in range(10):
        rig.tick(SLOW)
    position = list(rig.plant.position)
    for _ in range(20):
        rig.tick(SLOW)
    return text in (rig.driver.stop.reason or "") and rig.plant.position == position and not rig.driver.enabled


def without(can_id):
    """A tamper that loses the frames with this identifier on their way to the drives."""
    return lambda channel, frames, now: pack_frames(frame for frame in iter_frames(frames) if frame.can_id != can_id)


@pytest.mark.parametrize("name", ACTUATORS)
def test_an_emergency_of_one_drive_stops_all(rig, name):
    rig.tick(SLOW)
    rig.mock.drives[name].fault(0x4310)
    assert stopped_by(rig, f"{name}: EMCY 0x4310 (over-temperature of the drive)")


def test_a_drive_that_falls_silent_stops_all(rig):
    rig.tick(SLOW)
    rig.mock.drives["delta_3"].powered = False
    missing = [rig.tick(SLOW) for _ in range(rig.settings.report_limit)]
    assert missing == [None] * rig.settings.report_limit
    rig.mock.drives["delta_3"].powered = True
    assert stopped_by(rig, "delta_3: no TPDO while other drives are heard")


def test_a_computer_that_hears_nobody_waits_longer(rig):
    """It may be late itself: all five drives may miss nine ticks, one alone but two."""
    rig.tick(SLOW)
    rig.mock.tamper_frames = lambda channel, frames, now: b""
    for _ in range(rig.settings.missing_limit - 1):
        rig.tick(SLOW)
    rig.mock.tamper_frames = None
    rig.tick(SLOW)
    assert rig.driver.stop.first is None


def test_a_drive_that_is_not_heard_shields_no_other_axis(rig):
    """Another one goes 5 mm/s beside its command of -4: 10 um a tick, beyond 7 um and 3 ms of 4 mm/s in the second.

    The silence of the first would be told after 10 ticks, 100 um.
    """
    rig.tick(SLOW)
    rig.mock.drives["delta_3"].powered = False
    rig.mock.drives["tilt"].stray = lambda velocity: velocity + 5e-3
    number = ACTUATORS.index("tilt")
    before = rig.plant.position[number]
    for _ in range(150):
        rig.tick(SLOW)
    first = rig.driver.stop.first
    assert (first.reason, first.axes) == (Reason.POSITION_LEFT, (number,)) and first.value < 35e-6
    assert abs(rig.plant.position[number] - before) < 20e-6


def test_a_drive_that_misses_a_report_now_and_then_is_where_its_commands_put_it(rig):
    """Every other tick lacks the reports of one drive, which obeys: nobody objects for 0.3 s."""
    for tick in range(150):
        rig.mock.tamper_frames = (lambda channel, frames, now: frames[16:]) if tick % 2 else None
        rig.tick(SLOW)
    assert rig.driver.stop.first is None and rig.driver.counters["incomplete"] == 75


def test_a_drive_that_is_not_heard_loses_its_power(rig):
    """It goes on at 5 mm/s though it is told to brake: 0.8 mm in 0.3 s, a tenth of that until its silence is told."""
    tilt, number = rig.mock.drives["tilt"], ACTUATORS.index("tilt")
    rig.tick(SLOW)
    rig.mock.tamper_frames = lambda channel, frames, now: pack_frames(
        frame for frame in iter_frames(frames) if frame.can_id & 0x7F != tilt.node_id
    )
    tilt.stray = lambda velocity: velocity + 5e-3
    for _ in range(rig.settings.missing_limit + 5):
        rig.tick(SLOW)
    before = rig.plant.position[number]
    for _ in range(150):
        rig.tick(SLOW)
    assert "tilt: no TPDO" in rig.driver.stop.reason and rig.plant.position[number] == before


def test_one_lost_tpdo_is_counted_and_no_reason_to_stop(rig):
    rig.tick(SLOW)
    rig.mock.tamper_frames = lambda channel, frames, now: frames[16:] if channel else frames
    assert rig.tick(SLOW) is None
    rig.mock.tamper_frames = None
    feedback = rig.tick(SLOW)
    assert feedback is not None and rig.driver.stop.reason is None
    assert rig.driver.counters["incomplete"] == 1
    assert feedback.motor_velocity == pytest.approx([0.001, -0.002, 0.003, 0.1, -0.004], abs=0.02)


def test_a_drive_that_loses_power_is_not_enabled_again_by_itself(rig):
    rig.tick(SLOW)
    rig.mock.drives["tilt"].state = mock_drive.SWITCH_ON_DISABLED
    assert stopped_by(rig, "tilt: went to SWITCH_ON_DISABLED")


def test_a_drive_that_restarts_stops_all(rig):
    for _ in range(30):
        rig.tick(SLOW)
    rig.mock.drives["roll"].receive(od.NMT_ID, bytes([129, 4]), rig.now)
    assert stopped_by(rig, "roll")
    assert "restarted" in rig.driver.stop.reason or "TPDO" in rig.driver.stop.reason


@pytest.mark.parametrize(("state", "stops"), [(127, True), (4, True), (0, True), (5, False)])
def test_a_heartbeat_of_a_drive_that_is_not_operational_stops_all(rig, state, stops):
    """Its TPDOs may still come: the drive is on its way out."""
    for _ in range(30):
        rig.tick(SLOW)
    rig.device_links[0].send_frames(pack_frame(0x702, bytes([state])))
    rig.tick(SLOW)
    assert (rig.driver.stop.reason is not None) == stops
    assert not stops or rig.driver.stop.reason.startswith(f"delta_2: NMT state {state}")


@pytest.mark.parametrize("condition", [BusCondition.PASSIVE, BusCondition.OFF])
def test_error_passive_and_bus_off_stop_all(rig, condition):
    rig.tick(SLOW)
    rig.device_links[1].send_frames(pack_frame(*error_frame(condition)))
    assert stopped_by(rig, "error passive" if condition is BusCondition.PASSIVE else "bus off")
    assert rig.driver.watches.bus.conditions[1] is condition


def test_a_drive_without_heartbeat_stops_all_though_its_tpdos_come(rig):
    is_heartbeat = lambda frame: int.from_bytes(frame[:4], "little") & 0x780 == od.HEARTBEAT_BASE  # noqa: E731
    rig.mock.tamper_frames = lambda channel, frames, now: b"".join(
        frames[k : k + 16] for k in range(0, len(frames), 16) if not is_heartbeat(frames[k : k + 16])
    )
    for _ in range(round(rig.settings.drive_heartbeat_limit / rig.settings.period) + 5):
        rig.tick(SLOW)
    assert "no heartbeat" in rig.driver.stop.reason


def test_a_drive_that_faults_while_enabling_stops_all_at_once(make_rig):
    rig = make_rig()
    rig.driver.configure()
    rig.driver.enable()
    rig.tick()
    rig.mock.drives["delta_1"].state = mock_drive.FAULT  # and its EMCY got lost
    rig.tick()
    rig.tick()
    assert rig.driver.stop.reason == "delta_1: went to FAULT"


def test_a_drive_that_does_not_change_state_is_named(make_rig):
    rig = make_rig()
    rig.driver.configure()
    rig.mock.tamper_received = without(od.RPDO_BASE + rig.mock.drives["roll"].node_id)
    rig.driver.enable()
    for _ in range(round(rig.settings.transition_limit / rig.settings.period) + 10):
        rig.tick()
    assert "roll: stays in SWITCH_ON_DISABLED" in rig.driver.stop.reason
    assert not rig.driver.enabled


def test_frames_to_the_drives_can_be_held_back(rig):
    """The seam for a slow bus: all but SYNC and heartbeats come one tick late; the fourth late echo stops the robot."""
    held = {0: [], 1: []}

    def later(channel, frames, now):
        parts = [frames[k : k + 16] for k in range(0, len(frames), 16)]
        rpdos = [p for p in parts if int.from_bytes(p[:4], "little") & 0x780 == od.RPDO_BASE]
        held[channel] += [(now + rig.period_ns, p) for p in rpdos]
        due = [p for at, p in held[channel] if at <= now]
        held[channel] = [(at, p) for at, p in held[channel] if at > now]
        return b"".join([p for p in parts if p not in rpdos] + due)

    rig.mock.tamper_received = later
    demands = [rig.tick([0.001 * k] + [0.0] * 4).velocity_demand[0] for k in range(1, 5)]
    assert demands[-1] == pytest.approx(0.001 * 2, abs=1e-10)


def test_the_drives_hold_their_own_speed_limit(rig):
    """A target the driver would refuse, put on the bus by somebody else."""
    rig.tick(SLOW)
    rig.mock.poll()
    drive = rig.mock.drives["delta_1"]
    command = struct.pack("<Hi", 0x0F, 2_000_000_000)
    check = struct.pack("<H", check_of(command, drive.node_id, drive.counter))
    drive.receive(od.RPDO_BASE + 1, command + check, rig.now)
    demand = rig.tick(SLOW).velocity_demand[0]
    assert demand == pytest.approx(ROBOT.actuators[0].limits.velocity, rel=1e-9)
    assert rig.mock.drives["delta_1"].statusword & 0x0800


@pytest.mark.parametrize("length", [0, 6, 7])
def test_a_tpdo_of_another_length_is_counted_and_not_taken(rig, length):
    rig.mock.tamper_frames = lambda channel, frames, now: (
        frames[:4] + bytes([length]) + frames[5:] if channel else frames
    )
    assert rig.tick(SLOW) is None
    assert rig.driver.wire.collector.misfits == 1


def test_a_warning_stops_nothing(rig):
    rig.device_links[0].send_frames(pack_frame(*error_frame(BusCondition.WARNING)))
    rig.tick(SLOW)
    assert rig.driver.stop.reason is None and rig.driver.watches.bus.conditions[0] is BusCondition.WARNING


def test_a_meaningless_statusword_stops_all(rig):
    drive = rig.mock.drives["delta_1"]
    drive.state = 0x6C & ~0x40 | 0x04  # no CiA 402 state
    assert stopped_by(rig, "delta_1")


def test_a_dead_link_stops_the_robot_on_the_others(rig):
    rig.tick(SLOW)
    rig.host_links[1].close()
    for _ in range(10):
        rig.tick(SLOW)
    name, together = rig.host_links[1].name.partition("/")[::2]
    assert name in rig.driver.stop.reason and rig.driver.watches.bus.conditions[1] is BusCondition.OFF
    if together:  # all channels of the cable are dead: the drives stop by themselves
        rig.idle(50)
    assert rig.mock.drives["delta_1"].state == (mock_drive.FAULT if together else mock_drive.QUICK_STOP)


def test_the_host_dies_and_every_drive_stops_within_its_limits(rig):
    """Neither SYNC nor heartbeat: the drives hold the last demand until the consumer time, then brake on the ramp."""
    for _ in range(5):
        rig.tick([0.0122, -0.0122, 0.0122, 1.2, -0.0122])
    start = list(rig.plant.position)
    rig.idle(50)
    assert {drive.state for drive in rig.mock.drives.values()} == {mock_drive.FAULT}
    settled = list(rig.plant.position)
    rig.idle(50)
    assert rig.plant.position == settled
    limit = rig.settings.host_heartbeat_limit + rig.settings.host_heartbeat
    for begin, end, actuator in zip(start, settled, rig.driver.scales, strict=True):
        ramp = actuator.velocity_limit / (2.0 * 1.83 if actuator.name != "roll" else 2.0 * 20.0)
        worst = actuator.velocity_limit * (limit + ramp + 6 * rig.settings.period)
        assert 0 < abs(end - begin) < worst


def test_the_drives_stop_without_the_hosts_heartbeat_though_sync_and_commands_go_on(rig):
    rig.tick(SLOW)
    rig.mock.tamper_received = without(od.HEARTBEAT_BASE + rig.settings.host_id)
    for _ in range(50):
        rig.tick(SLOW)
    assert {drive.state for drive in rig.mock.drives.values()} == {mock_drive.FAULT}
    assert "0x8130" in rig.driver.stop.reason


def test_after_the_host_comes_back_nothing_moves_without_a_reset(rig):
    rig.tick(SLOW)
    rig.idle(50)
    assert stopped_by(rig, "heartbeat of the host lost")


def test_a_first_statusword_that_comes_late_is_no_stop(make_rig):
    """On a busy machine the first ticks have no TPDO yet; a drive that stays silent is still noticed by its absence."""
    rig = make_rig()
    rig.driver.configure()
    rig.mock.tamper_frames = lambda _channel, _frames, _now: b""
    for _ in range(rig.settings.missing_limit - 1):
        rig.tick()
    assert rig.driver.session.drives[0].state is None and rig.driver.stop.reason is None
    rig.tick()
    assert "no TPDO" in rig.driver.stop.reason
