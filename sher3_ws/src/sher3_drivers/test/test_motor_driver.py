"""The driver against the mock drives, over every CAN back-end: start, cycle, refusals, stops and recovery."""

import itertools
import math
import threading
import time

import pytest
from sher3_description import ACTUATORS, load_robot
from sher3_drivers import drive_objects as od
from sher3_drivers import mock_drive
from sher3_drivers.bus import open_link
from sher3_drivers.bus_load import BusLoadError
from sher3_drivers.can_errors import BusCondition, error_frame
from sher3_drivers.cia402 import TRANSITIONS, Command, Goal, State, transition
from sher3_drivers.drive_objects import Address
from sher3_drivers.errors import CommandRefused, ConfigurationError, DriveMismatch, DriveSilent
from sher3_drivers.frame import pack_frame
from sher3_drivers.lockstep_rig import LockstepRig
from sher3_drivers.mock_bus import MockDriveBus
from sher3_drivers.mock_plant import IntegratorPlant
from sher3_drivers.motor_driver import MotorDriver
from sher3_drivers.settings import MotorDriverSettings, default_settings

ROBOT = load_robot()
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
_numbers = itertools.count()


@pytest.fixture(params=["virtual", "local"])
def make_rig(request, tmp_path, monkeypatch):
    """A function that builds a rig; the whole suite runs on both links that need no hardware."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    rigs = []

    def make(**changes):
        prefix = f"{request.param}:d{next(_numbers)}"
        rigs.append(
            LockstepRig(ROBOT, default_settings().model_copy(update=changes), lambda i: open_link(f"{prefix}-{i}"))
        )
        return rigs[-1]

    yield make
    for rig in rigs:
        rig.close()


@pytest.fixture
def rig(make_rig):
    """An enabled rig."""
    made = make_rig()
    made.enable()
    return made


def run_cycle(rig):
    """Enable, move for 50 ticks, check the contract's timing and the travel."""
    rig.enable()
    rig.tick(SLOW)
    before = list(rig.plant.position)
    for k in range(1, 51):
        feedback = rig.tick([k / 50 * v for v in SLOW])
        expected = [max(1, k - 1) / 50 * v if k > 1 else v for v in SLOW]
        assert feedback.velocity_demand == pytest.approx(expected, abs=6e-10)
        assert feedback.stamp == rig.stamp
    travelled = [b - a for a, b in zip(before, rig.plant.position, strict=True)]
    total = 1.0 + sum(k / 50 for k in range(1, 50))
    assert travelled == pytest.approx([total * v * rig.settings.period for v in SLOW], rel=1e-6)
    assert rig.driver.counters["incomplete"] == 0 and rig.driver.stop.reason is None


@pytest.mark.parametrize("period", [0.002, 0.001])
@pytest.mark.parametrize("kind", ["virtual", "local"])
def test_the_cycle_on_the_default_layouts(kind, period, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    prefix = f"{kind}:c{next(_numbers)}"
    rig = LockstepRig(ROBOT, default_settings(period), lambda i: open_link(f"{prefix}-{i}"))
    run_cycle(rig)
    rig.close()


def test_the_cycle_on_one_channel_of_every_back_end(open_pair):
    """All five drives on one bus at 200 Hz, which one CAN interface carries."""
    layout = [{"link": "given", "drives": ACTUATORS}]
    rig = LockstepRig(ROBOT, MotorDriverSettings.checked(channels=layout, period=0.005), lambda i: open_pair())
    run_cycle(rig)
    rig.close()


def test_drives_that_get_their_power_late_are_waited_for_and_run_in_real_time(tmp_path, monkeypatch):
    """The two sides in two threads on the local link, the drives half a second after the driver."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    settings = default_settings()
    over = threading.Event()

    def drives():
        time.sleep(0.5)
        links = [open_link(channel.link) for channel in settings.channels]
        mock = MockDriveBus(links, IntegratorPlant(ROBOT, settings.period), ROBOT, settings)
        while not over.is_set():
            mock.serve(0.005)
        mock.close()

    thread = threading.Thread(target=drives)
    thread.start()
    try:
        driver = MotorDriver(ROBOT, settings, [open_link(channel.link) for channel in settings.channels])
        driver.configure(10.0)
        complete = 0
        for k in range(20):
            driver.tick(k)
            complete += driver.collect() is not None
            time.sleep(0.002)
        driver.close()
    finally:
        over.set()
        thread.join()
    assert complete > 0


def test_nothing_is_powered_before_enable(make_rig):
    rig = make_rig()
    rig.driver.configure()
    for _ in range(5):
        rig.tick(SLOW)
    assert rig.states() == {"SWITCH_ON_DISABLED"}
    assert rig.driver.counters["ignored"] == 5
    assert rig.plant.position == [0.0] * 5


def test_enabling_passes_zero_velocity_until_all_are_enabled(make_rig):
    rig = make_rig()
    rig.driver.configure()
    rig.driver.enable()
    while not rig.driver.enabled:
        rig.tick(SLOW)
    assert rig.plant.position == [0.0] * 5


def test_disable_brakes_and_takes_the_power_off(rig):
    rig.tick(SLOW)
    rig.driver.disable()
    for _ in range(10):
        feedback = rig.tick()
    assert rig.states() == {"SWITCH_ON_DISABLED"}
    assert feedback.velocity_demand == (0.0,) * 5


# Configuration.


def test_a_drive_that_does_not_answer_is_named(make_rig):
    rig = make_rig()
    rig.mock.drives["roll"].powered = False
    with pytest.raises(DriveSilent, match="roll"):
        rig.driver.configure()


@pytest.mark.parametrize(
    ("address", "value"),
    [
        (Address(0x1000, 0), 0x00030192),
        (Address(0x608F, 1), 100000),
        (Address(0x60E6, 1), 4096),
        (Address(0x6076, 0), 1),
        (Address(0x60EB, 1), 1),
    ],
)
def test_a_foreign_drive_is_refused_with_object_expected_and_found(make_rig, address, value):
    rig = make_rig()
    rig.mock.drives["delta_2"].node.factory[address] = value
    with pytest.raises(DriveMismatch) as caught:
        rig.driver.configure()
    assert caught.value.drive == "delta_2"
    assert str(address) in str(caught.value) and str(value) in str(caught.value)
    assert not any(drive.node.operational for drive in rig.mock.drives.values())


@pytest.mark.parametrize(
    "stubborn",
    [Address(0x1600, 1), Address(0x1800, 1), Address(0x1A01, 0), od.HOST_HEARTBEAT, od.MODE, Address(0x60A9, 0),
     Address(0x1401, 1)],
)  # fmt: skip
def test_a_drive_that_takes_a_write_but_does_not_keep_it_is_refused(make_rig, stubborn):
    rig = make_rig()
    drive = rig.mock.drives["tilt"]
    kept = dict(drive.node.values)

    class Forgetful(dict):
        def __setitem__(self, key, value):
            super().__setitem__(key, kept[key] ^ 2 if key == stubborn else value)

    drive.node.values = Forgetful(kept)
    with pytest.raises(DriveMismatch, match=str(stubborn)):
        rig.driver.configure()


def test_an_overloaded_channel_is_refused_before_anything_is_sent(make_rig):
    one = MotorDriverSettings.checked(channels=[{"link": "virtual:one", "drives": ACTUATORS}], period=0.001)
    with pytest.raises(BusLoadError, match="5 drives"):
        make_rig(channels=one.channels, period=0.001)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"channels": [{"link": "local:a", "drives": ACTUATORS[:4]}]}, "once"),
        ({"host_id": 3}, "host_id"),
        ({"host_heartbeat_limit": 0.006}, "trips"),
        ({"zero_age": 60}, "stop_age"),
        ({"period": math.nan}, "period"),
        ({"speed": 1}, "speed"),
    ],
)
def test_inconsistent_settings_are_refused(change, text):
    values = {"channels": [channel.model_dump() for channel in default_settings().channels], **change}
    with pytest.raises(ConfigurationError, match=text):
        MotorDriverSettings.checked(**values)


# Commands that must not pass.


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 0.0123, 1e300])
@pytest.mark.parametrize("axis", range(5))
def test_a_bad_command_is_refused_and_zero_is_sent(rig, bad, axis):
    rig.tick(SLOW)
    bad = bad if axis != 3 or not math.isfinite(bad) else bad * 100
    velocity = [bad if i == axis else v for i, v in enumerate(SLOW)]
    with pytest.raises(CommandRefused, match=ACTUATORS[axis]):
        rig.tick(velocity)
    assert rig.tick().velocity_demand == (0.0,) * 5


@pytest.mark.parametrize("periods", [-1, 4, 1000])
def test_a_command_of_another_time_is_refused(rig, periods):
    rig.tick(SLOW)
    with pytest.raises(CommandRefused, match="age"):
        rig.driver.command(rig.stamp - periods * rig.period_ns, SLOW)
    assert rig.tick().velocity_demand == (0.0,) * 5


def test_the_wrong_number_of_axes_is_refused(rig):
    with pytest.raises(CommandRefused, match="number"):
        rig.driver.command(rig.stamp, SLOW[:4])


def test_the_velocity_limit_itself_passes(rig):
    limits = [scale.velocity_limit for scale in rig.driver._scales]
    rig.tick(limits)
    assert rig.tick().velocity_demand == pytest.approx(limits, abs=6e-10)


def test_silence_of_commands_first_zeroes_then_stops(rig):
    demands = []
    rig.tick(SLOW)
    for _ in range(rig.settings.stop_age + 3):
        demands.append(rig.tick().velocity_demand[0])
    moving = [d for d in demands if d]
    assert len(moving) == rig.settings.zero_age
    assert rig.driver.goal is Goal.STOPPED and "no command" in rig.driver.stop.reason
    assert rig.states() == {"QUICK_STOP_ACTIVE"}


# Stops.


def stopped_by(rig, text):
    """Whether the robot came to rest with this reason and stays there, commands or not."""
    for _ in range(10):
        rig.tick(SLOW)
    position = list(rig.plant.position)
    for _ in range(20):
        rig.tick(SLOW)
    return text in (rig.driver.stop.reason or "") and rig.plant.position == position and not rig.driver.enabled


@pytest.mark.parametrize("name", ACTUATORS)
def test_an_emergency_of_one_drive_stops_all(rig, name):
    rig.tick(SLOW)
    rig.mock.drives[name].fault(0x4310)
    assert stopped_by(rig, f"{name}: EMCY 0x4310 (over-temperature of the drive)")


def test_a_drive_that_falls_silent_stops_all(rig):
    rig.tick(SLOW)
    rig.mock.drives["delta_3"].powered = False
    missing = [rig.tick(SLOW) for _ in range(rig.settings.missing_limit)]
    assert missing == [None] * rig.settings.missing_limit
    rig.mock.drives["delta_3"].powered = True
    assert stopped_by(rig, f"delta_3: no TPDO for {rig.settings.missing_limit} ticks")


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
    rig.tick(SLOW)
    rig.mock.drives["roll"].node.handle(0, bytes([129, 4]))
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
    assert rig.driver.bus_conditions[1] is condition


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
    rig.mock.drives["roll"]._on_controlword = lambda word: None
    rig.driver.enable()
    for _ in range(round(rig.settings.transition_limit / rig.settings.period) + 10):
        rig.tick()
    assert "roll: stays in SWITCH_ON_DISABLED" in rig.driver.stop.reason
    assert not rig.driver.enabled


def test_frames_to_the_drives_can_be_held_back(rig):
    """The seam for a slow bus: everything but SYNC and heartbeats reaches the drives one tick later."""
    held = {0: [], 1: []}

    def later(channel, frames, now):
        parts = [frames[k : k + 16] for k in range(0, len(frames), 16)]
        rpdos = [p for p in parts if int.from_bytes(p[:4], "little") & 0x780 == od.RPDO_BASE]
        held[channel] += [(now + rig.period_ns, p) for p in rpdos]
        due = [p for at, p in held[channel] if at <= now]
        held[channel] = [(at, p) for at, p in held[channel] if at > now]
        return b"".join([p for p in parts if p not in rpdos] + due)

    rig.mock.tamper_received = later
    demands = [rig.tick([0.001 * k] + [0.0] * 4).velocity_demand[0] for k in range(1, 8)]
    assert demands[-1] == pytest.approx(0.001 * 5, abs=1e-10)


def test_a_warning_stops_nothing(rig):
    rig.device_links[0].send_frames(pack_frame(*error_frame(BusCondition.WARNING)))
    rig.tick(SLOW)
    assert rig.driver.stop.reason is None and rig.driver.bus_conditions[0] is BusCondition.WARNING


def test_a_meaningless_statusword_stops_all(rig):
    drive = rig.mock.drives["delta_1"]
    drive.state = 0x6C & ~0x40 | 0x04  # no CiA 402 state
    assert stopped_by(rig, "delta_1")


def test_a_dead_link_stops_the_robot_on_the_others(rig):
    rig.tick(SLOW)
    rig.host_links[1].close()
    for _ in range(10):
        rig.tick(SLOW)
    assert rig.host_links[1].name in rig.driver.stop.reason and rig.driver.bus_conditions[1] is BusCondition.OFF
    assert rig.mock.drives["delta_1"].state == mock_drive.QUICK_STOP


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
    for begin, end, actuator in zip(start, settled, rig.driver._scales, strict=True):
        ramp = actuator.velocity_limit / (2.0 * 1.83 if actuator.name != "roll" else 2.0 * 20.0)
        worst = actuator.velocity_limit * (limit + ramp + 6 * rig.settings.period)
        assert 0 < abs(end - begin) < worst


def test_after_the_host_comes_back_nothing_moves_without_a_reset(rig):
    rig.tick(SLOW)
    rig.idle(50)
    assert stopped_by(rig, "heartbeat of the host lost")


# Recovery.


def test_reset_needs_a_stop_and_enabling_needs_a_reset(rig):
    with pytest.raises(CommandRefused, match="nothing is stopped"):
        rig.driver.reset()
    rig.driver.quick_stop("test")
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


def test_enabling_is_refused_in_fault_without_a_stop(make_rig):
    rig = make_rig()
    rig.driver.configure()
    rig.mock.drives["delta_3"].state = mock_drive.FAULT
    rig.tick()
    assert rig.driver.stop.reason is None
    with pytest.raises(CommandRefused, match="delta_3"):
        rig.driver.enable()
    rig.driver.reset()
    rig.tick()
    rig.tick()
    rig.enable()


def test_a_fault_is_reset_by_one_rising_edge_and_leaves_the_drive_disabled(rig):
    words = []
    drive = rig.mock.drives["delta_2"]
    original = drive._on_controlword
    drive._on_controlword = lambda word: (words.append(word), original(word))
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
    assert [e.code for e in rig.driver.health[4].emergencies] == [0x4310]


# The drives' state machine against the host's table.


_STATES = {
    State.NOT_READY_TO_SWITCH_ON: mock_drive.NOT_READY,
    State.SWITCH_ON_DISABLED: mock_drive.SWITCH_ON_DISABLED,
    State.READY_TO_SWITCH_ON: mock_drive.READY,
    State.SWITCHED_ON: mock_drive.SWITCHED_ON,
    State.OPERATION_ENABLED: mock_drive.ENABLED,
    State.QUICK_STOP_ACTIVE: mock_drive.QUICK_STOP,
    State.FAULT_REACTION_ACTIVE: mock_drive.FAULT_REACTION,
    State.FAULT: mock_drive.FAULT,
}


@pytest.mark.parametrize(("state", "command"), list(itertools.product(State, Command)))
def test_both_sides_of_the_wire_have_the_same_state_machine(state, command):
    """All pairs but transition 16, which drives have and the host's table leaves out."""
    after = mock_drive.next_state(_STATES[state], command.value, previous=0)
    if (state, command) == (State.QUICK_STOP_ACTIVE, Command.ENABLE_OPERATION):
        assert after == mock_drive.ENABLED and (state, command) not in TRANSITIONS
    else:
        assert after == _STATES[transition(state, command)]


@pytest.mark.parametrize("previous", [0x80, 0x8F])
def test_a_level_of_the_reset_bit_resets_nothing(previous):
    assert mock_drive.next_state(mock_drive.FAULT, 0x80, previous) == mock_drive.FAULT
