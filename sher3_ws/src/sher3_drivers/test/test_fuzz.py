"""Any bytes on the bus and from the devices: no side crashes, nothing moves that was not enabled, all is counted."""

import itertools
import math
import socket
import time

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sher3_description import load_robot
from sher3_drivers.bus.frame import ERROR_FLAG, Frame, mark, pack_frames
from sher3_drivers.bus.link import open_link
from sher3_drivers.bus.local import LocalCable
from sher3_drivers.canopen.objects import NODE_IDS
from sher3_drivers.mock.rig import LockstepRig
from sher3_drivers.pedal.local import LocalPedal
from sher3_drivers.sensor.device import WrenchRecord
from sher3_drivers.sensor.health import SensorFault, SensorHealth, SensorLimits, judge_record
from sher3_drivers.sensor.netft import RECORD, NetFtSensor
from sher3_drivers.sensor.netft_server import NetFtServer
from sher3_drivers.settings import default_settings

ROBOT = load_robot()
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
_numbers = itertools.count()

services = [0x000, 0x080, 0x180, 0x200, 0x280, 0x300, 0x380, 0x580, 0x600, 0x700]
ids = st.one_of(
    st.builds(lambda base, node: base + node, st.sampled_from(services), st.integers(0, 6)),
    st.integers(0, 0x7FF),
    st.integers(ERROR_FLAG, ERROR_FLAG + 0x1FF),
)
bursts = st.lists(st.builds(Frame, ids, st.binary(max_size=8)), max_size=30).map(pack_frames)
relaxed = settings(max_examples=150, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))


def make_rig():
    prefix = f"fuzz{next(_numbers)}"
    rig = LockstepRig(ROBOT, default_settings(), lambda i: open_link(f"virtual:{prefix}-{i}"))
    return rig, [open_link(f"virtual:{prefix}-{i}") for i in range(2)]


@pytest.fixture(scope="module")
def disabled():
    rig, intruders = make_rig()
    rig.driver.configure()
    yield rig, intruders
    rig.close()


def harmless(frames):
    """Whether the burst has nothing a drive must obey from anyone: no RPDO and no SDO request."""
    ids = [int.from_bytes(frames[k : k + 4], "little") & 0x780 for k in range(0, len(frames), 16)]
    return not {0x200, 0x300, 0x600} & set(ids)


@relaxed
@given(bursts.filter(harmless), st.integers(0, 1))
def test_a_disabled_robot_does_not_move_and_both_sides_live(disabled, frames, channel):
    rig, intruders = disabled
    intruders[channel].send_frames(frames)
    for _ in range(3):
        rig.tick(SLOW)
    assert rig.plant.position == [0.0] * 5


@relaxed
@given(bursts, st.integers(0, 1))
def test_no_frame_crashes_a_side(disabled, frames, channel):
    rig, intruders = disabled
    intruders[channel].send_frames(frames)
    for _ in range(2):
        rig.tick()


def test_frames_of_channels_that_do_not_exist_crash_no_side(runtime_folder):
    """Bytes of an intruder on a cable, whatever channel they say they are of."""
    rig = LockstepRig(ROBOT, default_settings(), "intruded")
    rig.driver.configure()
    intruder = LocalCable("intruded")

    @relaxed
    @given(bursts.filter(harmless), st.integers(0, 255))
    def intrude(frames, channel):
        intruder.send(mark(frames, channel))
        for _ in range(2):
            rig.tick(SLOW)
        assert rig.plant.position == [0.0] * 5

    intrude()
    intruder.close()
    rig.close()


@pytest.mark.parametrize("seed", range(20))
def test_an_enabled_robot_under_garbage_stays_within_its_limits(seed):
    """Whatever the garbage does, no axis ever moves faster than its velocity limit, and a stop is a stop."""
    import random

    rng = random.Random(seed)
    rig, intruders = make_rig()
    rig.enable()
    limits = [a.limits.velocity * 1.01 * rig.settings.period for a in ROBOT.actuators]
    for _ in range(60):
        count = rng.randrange(4)
        frames = [Frame(rng.choice(services) + rng.randrange(7), rng.randbytes(rng.randrange(9))) for _ in range(count)]
        intruders[rng.randrange(2)].send_frames(pack_frames(frames))
        before = list(rig.plant.position)
        rig.tick(SLOW)
        steps = [abs(after - b) for after, b in zip(rig.plant.position, before, strict=True)]
        # A SYNC of an intruder makes the plant step once more.
        assert all(step <= 5 * limit for step, limit in zip(steps, limits, strict=True))
    if rig.driver.stop.reason is not None:
        assert not rig.driver.enabled
    rig.close()


@relaxed
@given(bursts, st.integers(0, 1))
def test_what_has_another_length_or_address_is_counted_or_foreign(disabled, frames, channel):
    """A TPDO cut short on its drive's channel is a misfit; the collector takes nothing of it into the feedback."""
    rig, intruders = disabled
    rig.tick()
    before = rig.driver.wire.collector.misfits
    nodes = [NODE_IDS[name] for name in rig.settings.channels[channel].drives]
    lengths = {base + node: length for base, length in ((0x180, 8), (0x280, 8), (0x380, 2)) for node in nodes}
    heads = [(int.from_bytes(frames[k : k + 4], "little"), frames[k + 4]) for k in range(0, len(frames), 16)]
    cut = sum(length != lengths.get(can_id, length) for can_id, length in heads)
    intruders[channel].send_frames(frames)
    rig.tick()
    rig.tick()
    assert rig.driver.wire.collector.misfits - before == cut


def drained(sensor, server):
    """Read until the record that the server now sends has come."""
    server.publish((1.0, 2.0, 3.0, 0.01, 0.02, 0.03))
    deadline = time.monotonic() + 5.0
    while time.monotonic() < deadline:
        if (record := sensor.read(0, 0.05)) is not None:
            return record
    raise AssertionError("no record")


@pytest.fixture(scope="module")
def netft():
    server = NetFtServer(("127.0.0.1", 0))
    import threading

    serving = threading.Event()

    def serve():
        while not serving.is_set():
            server.poll()
            time.sleep(0.001)

    thread = threading.Thread(target=serve)
    thread.start()
    sensor = NetFtSensor(server.address)
    serving.set()
    thread.join()
    yield sensor, server
    sensor.close()
    server.close()


@relaxed
@given(st.lists(st.binary(max_size=70), max_size=8))
def test_any_datagram_of_the_force_sensor_is_a_record_or_counted(netft, datagrams):
    """What has the length of a record is one, and the checks judge its numbers; all else is a misfit."""
    sensor, server = netft
    before = sensor.misfits
    for data in datagrams:
        server.tamper_bytes = lambda _, sent=data: sent
        server.publish((0.0,) * 6)
    server.tamper_bytes = None
    record = drained(sensor, server)
    assert isinstance(record, WrenchRecord) and all(map(math.isfinite, record.wrench))
    assert sensor.misfits - before == sum(len(data) not in (0, RECORD.size) for data in datagrams)


@relaxed
@given(st.lists(st.tuples(*[st.integers(-(2**31), 2**31 - 1)] * 6), min_size=1, max_size=3), st.integers(0, 2**32 - 1))
def test_any_record_is_judged_without_a_crash(readings, status):
    """The counts of a record decode to a wrench whose fault is told whenever a component is not below its range."""
    limits, watch = SensorLimits.of(ROBOT.force_sensor), SensorHealth()
    for k, counts in enumerate(readings):
        wrench = tuple(c / (1e6 if i < 3 else 1e9) for i, c in enumerate(counts))
        watch, fault = judge_record(watch, WrenchRecord(wrench, k, status), limits)
        beyond = any(abs(w) >= r for w, r in zip(wrench, limits.rated, strict=True))
        assert fault is (SensorFault.DEVICE if status else fault) and (not beyond or fault.severe)


@relaxed
@given(st.lists(st.binary(max_size=40), max_size=8))
def test_any_request_leaves_the_mock_sensor_serving(netft, requests):
    sensor, server = netft
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        for data in requests:
            stranger.sendto(data, server.address)
    client = server.client
    server.poll()
    server.client = client  # a stranger that happened to ask for the stream
    assert drained(sensor, server).wrench == pytest.approx((1.0, 2.0, 3.0, 0.01, 0.02, 0.03))


@relaxed
@given(st.lists(st.binary(max_size=70), max_size=8))
def test_any_datagram_of_the_pedal_is_a_state_or_none(runtime_folder, datagrams):
    pedal = LocalPedal(f"fuzz-{next(_numbers)}")
    stranger = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
    try:
        for data in datagrams:
            stranger.sendto(data, str(pedal.path))
        state = pedal.read()
        assert state is None or isinstance(state.emergency_stop, bool)
    finally:
        pedal.close()
        stranger.close()
