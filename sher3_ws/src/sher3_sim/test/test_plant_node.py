"""The plant process in stepped time: moved over the CAN frames, its sensors on their device ends and topics."""

import itertools
import json

import numpy as np
import pytest
from sher3_common.samples import JointSample, JoySample, TextSample, WrenchSample
from sher3_description import load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.bus.lockstep import LockstepLink
from sher3_drivers.drive.motor_driver_node import MotorDriverNode
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.sensor.device import InProcessForceSensor
from sher3_drivers.settings import default_settings
from sher3_effects import plants
from sher3_effects.effects_file import effects_from_text
from sher3_runtime import Graph, on_tick
from sher3_sim.plant_node import PlantNode

pytestmark = pytest.mark.graph
ROBOT = load_robot()
_numbers = itertools.count()
OFFSET = json.dumps([{"effect": "encoder_offset", "actuator": "delta_1", "parameters": {"offset": 5e-4}}])


class Rig:
    """Plant and motor driver on one in-process link, with a probe."""

    def __init__(self, graph, effects=()):
        self.graph, self.force, self.pedal = graph, InProcessForceSensor(), InProcessPedal()
        settings, channel = default_settings(), f"plant{next(_numbers)}"
        ends = [[open_link(f"virtual:{channel}-{i}") for i in range(2)] for _ in range(2)]
        devices = {"force_device": self.force, "pedal_device": self.pedal}
        self.plant = graph.add(
            PlantNode, ROBOT, settings, effects, 3, None, ends[0], **devices, effects_of=effects_from_text
        )
        links = [LockstepLink(link, [self.plant.drives.poll]) for link in ends[1]]
        graph.add(MotorDriverNode, ROBOT, settings, links)
        topics = ("measured_js", "drives/setpoint_jv", "drives/measured_js", "tracker/measured_cp", "temperature")
        sends = (
            "servo_jv",
            "operating_state",
            "supervisor/heartbeat",
            "mock/contact_wrench",
            "mock/pedal",
            "mock/effects",
        )
        self.probe = graph.probe(*topics, sends=sends)
        self.beat = "DISABLED NONE"
        on_tick(self.probe, lambda _stamp: self.probe.send("supervisor/heartbeat", TextSample(self.beat)))

    def enable(self):
        self.graph.step()  # a heartbeat comes before the first state
        self.beat = "ENABLED NONE"
        self.probe.send("operating_state", TextSample("ENABLED"))
        self.graph.step(10)

    def move(self, velocity, ticks):
        for _ in range(ticks):
            self.probe.send("servo_jv", JointSample(self.graph.step(), None, velocity))
            self.graph.settle()

    def last(self, topic):
        return self.probe.samples[topic][-1]


@pytest.fixture
def rig():
    with Graph(period=ROBOT.control_period) as graph:
        yield Rig(graph)


def test_the_robot_moves_over_the_bus_and_the_tracker_sees_it(rig):
    rig.enable()
    before = np.array(rig.last("measured_js").position)
    rig.move((0.002, 0.002, 0.002, 0.0, 0.0), 75)
    after = np.array(rig.last("measured_js").position)
    assert after[:3] - before[:3] == pytest.approx([3e-4] * 3, rel=0.1)
    assert np.abs(after[3:] - before[3:]).max() < 1e-4
    poses = rig.probe.samples["tracker/measured_cp"]
    assert len(poses) >= 15 and poses[-1].position[2] - poses[0].position[2] == pytest.approx(3e-4, rel=0.1)
    assert poses[-1].stamp % round(ROBOT.control_period * 1e9) == 0
    assert np.mean([s.effort[0] for s in rig.probe.samples["drives/measured_js"]]) > 1.0  # holds the platform


def test_contact_and_pedal_reach_their_devices_and_let_go_when_silent(rig):
    rig.enable()
    rest = np.array(rig.force.read(0, 0).wrench)
    for _ in range(5):
        stamp = rig.graph.step()
        rig.probe.send("mock/contact_wrench", WrenchSample(stamp, (0.0, 0.0, 1.5, 0.0, 0.0, 0.0)))
        rig.probe.send("mock/pedal", JoySample(stamp, (0.75,), (1,)))
        rig.graph.settle()
    rig.graph.step(2)
    assert np.array(rig.force.read(0, 0).wrench) - rest == pytest.approx([0, 0, 1.5, 0, 0, 0], abs=0.05)
    assert rig.pedal.read()[:2] == (0.75, True)
    rig.graph.step(105)
    assert np.array(rig.force.read(0, 0).wrench) == pytest.approx(rest, abs=0.05)
    assert rig.pedal.read()[:2] == (0.0, False)


def test_a_wrench_that_is_not_finite_is_ignored(rig):
    rig.enable()
    rig.probe.send("mock/contact_wrench", WrenchSample(rig.graph.step(), (float("nan"),) * 6))
    rig.graph.step(5)
    assert np.isfinite(rig.force.read(0, 0).wrench).all()
    assert np.isfinite(rig.last("measured_js").position).all()


def test_temperature_once_a_second(rig):
    rig.graph.step(505)
    samples = rig.probe.samples["temperature"]
    assert 1 <= len(samples) <= 2 and {s.temperature for s in samples} == {22.0}


def test_effects_act_in_the_running_plant():
    with Graph(period=ROBOT.control_period) as graph:
        rig = Rig(graph, [plants()["command_delay"]("all", delay=ROBOT.control_period)])
        rig.enable()
        rig.move((0.001, 0.0, 0.0, 0.0, 0.0), 5)
        graph.step(2)
        echoes = [sample.velocity[0] for sample in rig.probe.samples["drives/setpoint_jv"]]
        commanded = echoes.index(pytest.approx(0.001, abs=1e-8))
        with_delay = len(echoes) - commanded
        assert with_delay == 5  # seven ticks since the first command, less one nominal tick and one of delay


def test_effects_are_exchanged_while_the_plant_runs():
    """An offset of 0.5 mm in the encoder is there, and gone again; what is refused changes nothing."""
    with Graph(period=ROBOT.control_period) as graph:
        rig = Rig(graph)
        rig.enable()
        start = rig.last("measured_js").position[0]
        for text, shift in ((OFFSET, 5e-4), ('[{"effect": "no", "actuator": "tilt"}]', 5e-4), ("x", 5e-4), ("[]", 0.0)):
            rig.probe.send("mock/effects", TextSample(text))
            graph.step(20)
            assert rig.last("measured_js").position[0] - start == pytest.approx(shift, abs=5e-6)
