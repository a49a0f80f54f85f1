"""Force readings: the checks as pure functions, the NetFT protocol against its mock, and times of arrival."""

import math
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_description import load_robot
from sher3_drivers.errors import DeviceMissing
from sher3_drivers.sensor.device import InProcessForceSensor, WrenchRecord
from sher3_drivers.sensor.health import SensorFault, SensorHealth, SensorLimits, judge_record
from sher3_drivers.sensor.netft import RECORD, NetFtScale, NetFtSensor
from sher3_drivers.sensor.netft_server import NetFtServer

LIMITS = SensorLimits.of(load_robot().force_sensor)
QUIET = (0.1, 0.2, 0.3, 0.001, 0.002, 0.003)


def judge(*records):
    """The faults of records in a row."""
    watch, faults = SensorHealth(), []
    for record in records:
        watch, fault = judge_record(watch, record, LIMITS)
        faults.append(fault)
    return faults


def with_component(axis, value):
    return tuple(value if i == axis else x for i, x in enumerate(QUIET))


def test_a_live_sensor_has_no_fault():
    assert set(judge(*(WrenchRecord(with_component(0, 0.01 * k), k) for k in range(100)))) == {SensorFault.NONE}


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_each_component_is_judged(axis, sign):
    rated = LIMITS.rated[axis]
    cases = {
        math.nan: SensorFault.NOT_FINITE,
        sign * math.inf: SensorFault.NOT_FINITE,
        sign * rated * 2.1: SensorFault.OUT_OF_RANGE,
        sign * rated: SensorFault.SATURATED,
        sign * rated * 0.99: SensorFault.NONE,
    }
    for value, fault in cases.items():
        assert judge(WrenchRecord(with_component(axis, value), 1)) == [fault]


@given(st.tuples(*[st.floats() for _ in range(6)]), st.integers(0, 2**32 - 1))
def test_no_reading_beyond_the_range_passes(wrench, status):
    fault = judge(WrenchRecord(wrench, 7, status))[0]
    believable = all(abs(w) < r for w, r in zip(wrench, LIMITS.rated, strict=True))
    assert (fault is SensorFault.NONE) == (believable and not status)


def test_a_force_that_jumps_to_and_fro_is_no_hand():
    """11 N either way at 125 Hz stays within the range; the third jump within 50 ms gives it away."""
    square = [WrenchRecord(with_component(2, 11.0 if k // 2 % 2 else -11.0), k) for k in range(12)]
    assert judge(*square)[:7] == [SensorFault.NONE] * 6 + [SensorFault.ABSURD]


def test_a_sine_that_jumps_is_no_hand():
    sine = [WrenchRecord(with_component(0, 11.5 * math.sin(2.0 * math.pi * 25.0 * 0.002 * k)), k) for k in range(40)]
    assert SensorFault.ABSURD in judge(*sine)


def test_a_firm_push_that_is_turned_round_is_one_movement():
    """5 N on the tip's lever, turned round within 24 ms, jumps in several records and in one direction."""
    ramp = [0.8 * max(-1.0, 1.0 - k / 6.0) for k in range(40)]
    turned = [WrenchRecord(tuple(share * rated for rated in LIMITS.rated), k) for k, share in enumerate(ramp)]
    noisy = [r._replace(wrench=with_component(2, r.wrench[2] + 1e-3 * (r.sequence % 2))) for r in turned]
    assert set(judge(*turned)[:18]) == {SensorFault.NONE} == set(judge(*noisy))


def test_a_hit_on_the_tool_is_one_jump_or_two():
    forces = [0.3] * 5 + [8.0, 7.0] + [0.3] * 30 + [8.0] + [0.3] * 5
    noisy = [WrenchRecord(with_component(2, f + 1e-3 * (k % 2)), k) for k, f in enumerate(forces)]
    assert set(judge(*noisy)) == {SensorFault.NONE}


def test_frozen_after_eight_identical_readings():
    faults = judge(*(WrenchRecord(QUIET, k) for k in range(20)))
    assert faults[:7] == [SensorFault.NONE] * 7 and set(faults[7:]) == {SensorFault.FROZEN}


def test_one_changed_bit_thaws():
    stuck = [WrenchRecord(QUIET, k) for k in range(20)]
    moved = WrenchRecord(with_component(5, math.nextafter(0.003, 1.0)), 20)
    assert judge(*stuck, moved)[-1] is SensorFault.NONE


def test_no_record_is_silence_and_a_status_word_a_device_fault():
    assert judge(None, WrenchRecord(QUIET, 1, 0x80000000)) == [SensorFault.SILENT, SensorFault.DEVICE]


@pytest.mark.parametrize(
    ("sequences", "fault"),
    [
        ((1, 2), SensorFault.NONE),
        ((2**32 - 1, 0), SensorFault.NONE),
        ((1, 3), SensorFault.SEQUENCE),
        ((3, 2), SensorFault.SEQUENCE),
        ((3, 3), SensorFault.SEQUENCE),
    ],
)
def test_lost_and_reordered_records_are_seen(sequences, fault):
    records = [WrenchRecord(with_component(0, 0.1 * k), s) for k, s in enumerate(sequences)]
    assert judge(*records)[-1] is fault


def test_lost_records_are_counted():
    watch, _ = judge_record(SensorHealth(), WrenchRecord(QUIET, 10), LIMITS)
    watch, _ = judge_record(watch, WrenchRecord(QUIET, 20, drained=4), LIMITS)
    assert watch.lost == 6


def test_in_process_sensor_gives_each_record_once():
    sensor = InProcessForceSensor()
    sensor.put(QUIET)
    sensor.put(with_component(0, 1.0))
    record = sensor.read(0, 0.0)
    assert record is not None and record.wrench[0] == 1.0 and (record.sequence, record.drained) == (2, 2)
    assert sensor.read(0, 0.0) is None


# The protocol.


@pytest.fixture
def pair():
    """A mock NetFT and a sensor that reads it."""
    server = NetFtServer(("127.0.0.1", 0))
    sensor = connect(server)
    yield server, sensor
    sensor.close()
    server.close()


def connect(server):
    """Open a sensor while the server is served from the same thread: its request waits in the socket meanwhile."""
    import threading

    ready = threading.Event()
    thread = threading.Thread(target=lambda: [(server.poll(), time.sleep(0.001)) for _ in iter(ready.is_set, True)])
    thread.start()
    try:
        return NetFtSensor(server.address, answer_limit=5.0)
    finally:
        ready.set()
        thread.join()


def test_a_wrench_survives_the_wire_to_the_sensor_resolution(pair):
    server, sensor = pair
    resolution = (1 / 320, 1 / 320, 1 / 320, 1 / 64000, 1 / 64000, 1 / 64000)
    wrench = tuple(n * r for n, r in zip((-960, 320, 17, 64, -640, 5), resolution, strict=True))
    since = time.monotonic_ns()
    server.publish(wrench)
    record = sensor.read(since, 1.0)
    assert record is not None and record.wrench == pytest.approx(wrench, rel=1e-12)


def test_a_late_record_is_not_taken_for_the_next_ticks(pair):
    server, sensor = pair
    server.publish(QUIET)
    time.sleep(0.002)
    since = time.monotonic_ns()
    assert sensor.read(since, 0.005) is None
    server.publish(with_component(0, 2.0))
    record = sensor.read(since, 1.0)
    assert record is not None and record.wrench[0] == 2.0 and record.drained == 2


def test_status_and_tamper_reach_the_reader(pair):
    server, sensor = pair
    server.status = 0x02
    server.publish(QUIET)
    record = sensor.read(0, 1.0)
    assert record is not None and record.status == 2
    server.tamper_bytes = lambda record: b""
    server.publish(QUIET)
    assert sensor.read(0, 0.005) is None
    server.tamper_bytes = lambda record: record[:-1]
    server.publish(QUIET)
    assert sensor.read(0, 0.005) is None


def test_a_nan_on_the_wire_reads_as_out_of_range(pair):
    server, sensor = pair
    server.publish(with_component(2, math.nan))
    record = sensor.read(0, 1.0)
    assert judge(record) == [SensorFault.OUT_OF_RANGE]


@given(st.binary(max_size=48))
def test_the_server_ignores_what_is_no_request(data):
    import socket

    server = NetFtServer(("127.0.0.1", 0))
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        client.sendto(data, server.address)
        server.poll()
        server.publish(QUIET)
    server.close()


def test_no_device_is_named_with_a_remedy():
    server = NetFtServer(("127.0.0.1", 0))
    address = server.address
    server.close()
    with pytest.raises(DeviceMissing, match="--mock"):
        NetFtSensor(address, answer_limit=0.1)


def test_a_taken_port_is_named():
    server = NetFtServer(("127.0.0.1", 0))
    with pytest.raises(DeviceMissing, match="port"):
        NetFtServer(server.address)
    server.close()


def test_counts_are_the_devices():
    assert NetFtScale().to_counts((1.0, 0.0, -2.0, 0.001, 0.0, 0.0)) == (1000000, 0, -2000000, 1000000, 0, 0)
    assert RECORD.size == 36
