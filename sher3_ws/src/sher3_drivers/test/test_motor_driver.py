"""The driver against the mock drives: start, cycle on every CAN back-end, commands that must not pass."""

import itertools
import math
import threading
import time

import pytest
from sher3_common.reasons import Reason
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.bus.load import BusLoadError
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.canopen.objects import Address
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_drivers.errors import CommandRefused, DriveMismatch, DriverSettingsError, DriveSilent
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.mock.rig import LockstepRig
from sher3_drivers.settings import MotorDriverSettings, default_settings
from sher3_drivers.watches.trips import Trip

ROBOT = load_robot()
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
_numbers = itertools.count()


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
def test_the_cycle_on_the_default_layouts(kind, period, runtime_folder):
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


def test_drives_that_get_their_power_late_are_waited_for_and_run_in_real_time(runtime_folder):
    """The two sides in two threads on the local link, the drives half a second after the driver.

    A busy computer may leave either thread waiting for longer than the 0.3 s in which a drive answers, and once no
    answer came for 2 s, nobody knows why: after 20 s it is lost.
    """
    settings = default_settings().model_copy(update={"sdo_limit": 20.0})
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
        for k in range(2000):
            driver.tick(k)
            if driver.collect() is not None:
                break
            time.sleep(0.002)
        else:
            pytest.fail("no complete tick in 4 s")
        driver.close()
    finally:
        over.set()
        thread.join()


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


def test_a_drive_that_does_not_answer_is_named(make_rig):
    rig = make_rig()
    rig.mock.drives["roll"].powered = False
    with pytest.raises(DriveSilent, match="roll"):
        rig.driver.configure()


def test_a_drive_that_does_not_become_operational_is_named(make_rig):
    rig = make_rig()
    node = rig.mock.drives["tilt"].node
    handle = node.handle
    node.handle = lambda can_id, data: None if can_id == 0 and data[:1] == b"\x01" else handle(can_id, data)
    with pytest.raises(DriveSilent, match="tilt: does not become OPERATIONAL"):
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
    with pytest.raises(DriverSettingsError, match=text):
        MotorDriverSettings.checked(**values)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 0.0123, 1e300])
@pytest.mark.parametrize("axis", range(5))
def test_a_bad_command_is_refused_and_zero_is_sent(rig, bad, axis):
    rig.tick(SLOW)
    bad = bad if axis != 3 or not math.isfinite(bad) else bad * 100
    velocity = [bad if i == axis else v for i, v in enumerate(SLOW)]
    with pytest.raises(CommandRefused, match=ACTUATORS[axis]):
        rig.tick(velocity)
    assert rig.tick().velocity_demand == (0.0,) * 5


@pytest.mark.parametrize("periods", [-1000, -4, 4, 1000])
def test_a_command_of_another_time_is_refused(rig, periods):
    rig.tick(SLOW)
    with pytest.raises(CommandRefused, match="age"):
        rig.driver.command(rig.stamp - periods * rig.period_ns, SLOW)
    assert rig.tick().velocity_demand == (0.0,) * 5


def test_an_early_command_waits_for_its_tick(rig):
    """A driver process that runs late finds the commands of ticks it has not begun."""
    rig.tick(SLOW)
    rig.driver.command(rig.stamp + rig.period_ns, [2 * v for v in SLOW])
    assert rig.tick().velocity_demand == pytest.approx(SLOW, abs=6e-10)
    assert rig.tick().velocity_demand == pytest.approx([2 * v for v in SLOW], abs=6e-10)


def test_an_early_command_is_forgotten_at_a_stop(rig):
    rig.tick(SLOW)
    rig.driver.command(rig.stamp + rig.period_ns, SLOW)
    rig.driver.stop_for(Trip(Reason.SUPERVISOR_FAULT, "test"))
    for _ in range(10):
        rig.tick()
    position = list(rig.plant.position)
    rig.driver.reset()
    rig.tick()
    assert rig.plant.position == position


def test_the_wrong_number_of_axes_is_refused(rig):
    with pytest.raises(CommandRefused, match="number"):
        rig.driver.command(rig.stamp, SLOW[:4])


def test_the_velocity_limit_itself_passes(rig):
    limits = [scale.velocity_limit for scale in rig.driver.scales]
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
