"""Any bytes on any topic of any node: nothing crashes, nothing moves, everything that is no message is counted."""

import math
import random

import pytest
from robot_rig import ROBOT, RobotRig
from sher3_bags.recording.recorder_node import RecorderNode
from sher3_common.samples import (
    DiagnosticSample,
    JointSample,
    JoySample,
    PoseSample,
    TemperatureSample,
    TextSample,
    TwistSample,
    WrenchSample,
)
from sher3_control.supervision.detectors import TwinDetector
from sher3_description import ACTUATORS, TOPICS
from sher3_runtime import Graph
from sher3_runtime.codec.cdr import CdrError, codec
from sher3_runtime.ports import NODE_OPTIONS, advertise_raw, ports, statistics_of

WILD = (math.nan, math.inf, -math.inf, 1e300, -1e300, 5e-324, -0.0, 1e9, 2.0**31, 1.0, 0.0)
SINGLE = tuple(value for value in WILD if not 1e38 < abs(value) < math.inf)
TEXTS = ("", "enable\n", "ENABLED ", "{", "[" * 60_000, '{"mode": 3}', "é" * 100, "null", "1e999", "[]")
STAMPS = (0, -1, 1, 2**31 * 10**9 - 1, -(2**31) * 10**9)


class Attacker:
    """Publishes raw bytes on every topic that somebody of the robot listens to."""

    def __init__(self, rig):
        from rclpy.node import Node

        nodes = list(rig.graph.nodes)
        self.graph, self.nodes = rig.graph, nodes
        self.topics = sorted({name for node in nodes for name in ports(node).subscriptions})
        self.node = rig.graph.add(lambda **options: Node("attacker", **{**NODE_OPTIONS, **options}))
        self._send = {name: advertise_raw(self.node, name) for name in self.topics}
        self.codec = {n: codec(TOPICS[n].type, TOPICS[n].frame_id, ACTUATORS) for n in self.topics}
        self.invalid = 0

    def send(self, topic, data):
        """Send; count whether the listeners must have refused it."""
        try:
            self.codec[topic].decode(data)
        except CdrError:
            self.invalid += self.listeners(topic)
        self._send[topic](data)
        self.graph.settle()

    def listeners(self, topic):
        """How many take every message of the topic; the rest look at the newest at times, or record bytes."""
        heard = ((ports(node).subscriptions.get(topic), ports(node).deliveries) for node in self.nodes)
        return sum(taken is not None and taken.handle.pointer in deliveries for taken, deliveries in heard)

    @property
    def counted(self):
        return sum(sum(statistics_of(node).garbage.values()) for node in self.nodes)

    def encode(self, topic, sample):
        return self.codec[topic].encode(sample)


def wild_sample(rng, kind, now):
    """A message of the right form with any content."""
    x = lambda n: tuple(rng.choice(WILD) for _ in range(n))  # noqa: E731
    stamp = rng.choice((now, now + 10**12, *STAMPS))
    return {
        "JointState": lambda: JointSample(stamp, *(x(5) if rng.random() < 0.7 else None for _ in range(3))),
        "TwistStamped": lambda: TwistSample(stamp, x(6)),
        "WrenchStamped": lambda: WrenchSample(stamp, x(6)),
        "PoseStamped": lambda: PoseSample(stamp, x(3), x(4)),
        "Joy": lambda: JoySample(
            stamp, rng.sample(SINGLE, rng.randrange(3)), (rng.randrange(-3, 3),) * rng.randrange(3)
        ),
        "Temperature": lambda: TemperatureSample(stamp, x(1)[0]),
        "String": lambda: TextSample(rng.choice(TEXTS)),
        "DiagnosticArray": lambda: DiagnosticSample(stamp, rng.choice(TEXTS)[:99], 2, "", (("", ""),)),
    }[kind]()


def spoilt(rng, data):
    """A message with bytes flipped, cut, doubled or replaced."""
    data = bytearray(data)
    for _ in range(rng.randrange(1, 5)):
        at = rng.randrange(len(data))
        data[at] = rng.randrange(256)
    how = rng.randrange(4)
    if how == 0:
        data = data[: rng.randrange(len(data))]
    elif how == 1:
        data += bytes(rng.randrange(1, 9))
    elif how == 2:
        data = data[:4] + rng.randbytes(rng.randrange(64))
    return bytes(data)


@pytest.fixture
def robot(bag_folder):
    with Graph() as graph:
        rig = RobotRig(graph)
        recorder = graph.add(RecorderNode, bag_folder, ROBOT)
        yield rig, Attacker(rig)
        recorder.close()


def demands(rig):
    return rig.plant.reading.demand.tolist()


@pytest.mark.graph
def test_a_disabled_robot_lives_and_rests(robot):
    """Random bytes, spoilt messages and messages with absurd numbers, on every topic, with every node listening."""
    rig, attacker = robot
    rng = random.Random(4)
    rig.graph.step(20)
    assert len(attacker.topics) >= 20
    for topic in attacker.topics:
        kind = TOPICS[topic].type.rsplit("/", 1)[-1]
        for k in range(12):
            whole = attacker.encode(topic, wild_sample(rng, kind, rig.graph.clock.time_ns))
            attacker.send(topic, (whole, spoilt(rng, whole), rng.randbytes(rng.randrange(80)))[k % 3])
            if k % 4 == 3:
                rig.graph.step(1)
                assert demands(rig) == [0] * 5, topic
    rig.graph.step(20)
    assert not rig.motor_driver.driver.enabled and rig.supervisor.supervisor.state.value in ("DISABLED", "FAULT")
    assert attacker.counted >= attacker.invalid > 100


@pytest.mark.graph
def test_an_enabled_robot_rests_while_all_that_is_no_message_arrives(robot):
    """With the pedal released nothing moves; every refused message is counted by each of its listeners."""
    rig, attacker = robot
    rng = random.Random(5)
    twins = next(d for d in rig.supervisor.supervisor.detectors if isinstance(d, TwinDetector))
    twins.limit = 2  # the attacker is the second publisher of every stream, and would be seen
    rig.graph.step(50)
    attacker.send("command/state_command", attacker.encode("command/state_command", TextSample("enable")))
    for _ in range(200):
        rig.graph.step(1)
        if rig.motor_driver.driver.enabled:
            break
    assert rig.motor_driver.driver.enabled, rig.supervisor.supervisor.status
    before, invalid = attacker.counted, attacker.invalid
    for topic in attacker.topics:
        kind = TOPICS[topic].type.rsplit("/", 1)[-1]
        for _ in range(6):
            while True:
                data = spoilt(rng, attacker.encode(topic, wild_sample(rng, kind, rig.graph.clock.time_ns)))
                try:
                    attacker.codec[topic].decode(data)
                except CdrError:
                    break
            attacker.send(topic, data)
        rig.graph.step(1)
        assert demands(rig) == [0] * 5, topic
    rig.graph.step(5)
    assert attacker.counted - before >= attacker.invalid - invalid > 100
    assert rig.supervisor.supervisor.state.value == "ENABLED", "garbage is dropped; the streams go on beside it"
