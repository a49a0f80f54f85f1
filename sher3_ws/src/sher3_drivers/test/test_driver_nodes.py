"""The nodes in one process and stepped time: topics, stamps, and what happens on states, silence and loss."""

import itertools
import math

import pytest
from sher3_common.samples import JointSample, TextSample
from sher3_description import load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.bus.lockstep import LockstepLink
from sher3_drivers.drive.motor_driver_node import MotorDriverNode
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.pedal.device import PedalState
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.pedal.pedal_node import PedalNode
from sher3_drivers.sensor.device import InProcessForceSensor
from sher3_drivers.sensor.force_sensor_node import ForceSensorNode
from sher3_drivers.settings import default_settings
from sher3_runtime import Graph, on_tick

pytestmark = pytest.mark.graph
ROBOT = load_robot()
SLOW = (0.001, -0.002, 0.003, 0.1, -0.004)
_numbers = itertools.count()


@pytest.fixture
def graph():
    with Graph(period=ROBOT.control_period) as made:
        yield made


class Drives:
    """A motor driver node on mock drives in a graph, with a probe."""

    def __init__(self, graph):
        self.graph = graph
        settings = default_settings()
        channel = f"node{next(_numbers)}"
        ends = [[open_link(f"virtual:{channel}-{i}") for i in range(2)] for _ in range(2)]
        self.mock = MockDriveBus(
            ends[0], IntegratorPlant(ROBOT, settings.period), ROBOT, settings, lambda: graph.clock.time_ns
        )
        links = [LockstepLink(link, [self.mock.poll]) for link in ends[1]]
        self.node = graph.add(MotorDriverNode, ROBOT, settings, links)
        topics = ("measured_js", "drives/measured_js", "drives/setpoint_jv", "diagnostics")
        self.probe = graph.probe(*topics, sends=("servo_jv", "operating_state", "supervisor/heartbeat"))
        self.beat = "DISABLED NONE"
        on_tick(self.probe, lambda _stamp: self.probe.send("supervisor/heartbeat", TextSample(self.beat)))

    def state(self, text, action="NONE"):
        self.graph.step()  # a heartbeat comes before the first state
        self.beat = f"{text} {action}"
        self.probe.send("operating_state", TextSample(text))
        self.graph.step(8)

    def move(self, velocity, ticks=1):
        for _ in range(ticks):
            stamp = self.graph.step()
            self.probe.send("servo_jv", JointSample(stamp, None, velocity))
            self.graph.settle()

    def report(self):
        self.graph.step(120)
        return [s for s in self.probe.samples["diagnostics"] if s.name.startswith("motor_driver")][-1]


@pytest.fixture
def drives(graph):
    return Drives(graph)


def test_every_tick_has_its_three_samples_with_its_stamp(drives):
    last = drives.graph.step(20)
    for topic in ("measured_js", "drives/measured_js", "drives/setpoint_jv"):
        stamps = [sample.stamp for sample in drives.probe.samples[topic]]
        period = drives.graph.clock.period_ns
        assert stamps == [last - period * k for k in range(19, -1, -1)]


def test_the_echo_is_the_command_of_the_tick_before(drives):
    drives.state("ENABLED")
    drives.move(SLOW, 3)
    drives.graph.step()
    sample = drives.probe.samples["drives/setpoint_jv"][-1]
    assert sample.velocity == pytest.approx(SLOW, abs=6e-10) and sample.position is None


def test_nothing_moves_while_disabled(drives):
    drives.move(SLOW, 20)
    assert drives.mock.plant.position == [0.0] * 5


def test_fault_stops_and_only_disable_then_enable_recovers(drives):
    drives.state("ENABLED")
    drives.move(SLOW, 5)
    drives.state("FAULT")
    resting = list(drives.mock.plant.position)
    drives.state("ENABLED")
    drives.move(SLOW, 20)
    assert drives.mock.plant.position == resting
    drives.state("DISABLED")
    drives.state("ENABLED")
    drives.move(SLOW, 5)
    assert drives.mock.plant.position != resting


def test_a_silent_controller_stops_the_drives_and_is_reported(drives):
    drives.state("ENABLED")
    drives.move(SLOW, 5)
    report = drives.report()
    assert report.level == 2 and "no command" in report.message
    assert dict(report.values)["delta_1.state"] == "QUICK_STOP_ACTIVE"


def test_a_bad_command_stops_in_the_same_tick_and_is_reported(drives):
    drives.state("ENABLED")
    drives.move(SLOW, 5)
    drives.move((math.nan, 0.0, 0.0, 0.0, 0.0))
    drives.graph.step()
    assert drives.probe.samples["drives/setpoint_jv"][-1].velocity == (0.0,) * 5
    assert "delta_1" in dict(drives.report().values)["refused"]


def test_a_lost_drive_leaves_a_gap_and_a_report(drives):
    drives.state("ENABLED")
    before = len(drives.probe.samples["measured_js"])
    drives.mock.drives["roll"].powered = False
    report = drives.report()
    assert len(drives.probe.samples["measured_js"]) == before
    assert report.level == 2 and "roll: no TPDO" in report.message


def test_force_is_published_raw_once_a_tick(graph):
    device = InProcessForceSensor()
    graph.add(ForceSensorNode, ROBOT, device)
    probe = graph.probe("force/measured_cf")
    for k in range(3):
        device.put((0.1 * k, 20.0, 0.0, 0.0, 0.0, 0.0))
        stamp = graph.step()
        assert probe.samples["force/measured_cf"][-1] == (stamp, (0.1 * k, 20.0, 0.0, 0.0, 0.0, 0.0))
    graph.step(5)
    assert len(probe.samples["force/measured_cf"]) == 3


def test_what_only_the_sensor_knows_is_nan(graph):
    device = InProcessForceSensor()
    graph.add(ForceSensorNode, ROBOT, device)
    probe = graph.probe("force/measured_cf", "diagnostics")
    device.put((0.0,) * 6, status=4)
    graph.step(60)
    assert all(map(math.isnan, probe.samples["force/measured_cf"][0].wrench))
    assert next(s.level for s in probe.samples["diagnostics"] if "force_sensor: readings" in s.name) == 2


def test_the_pedal_is_a_stream_and_its_loss_is_nan_and_stop(graph):
    device = InProcessPedal()
    graph.add(PedalNode, ROBOT, device)
    probe = graph.probe("pedal/measured")
    graph.step(3)
    assert not probe.samples["pedal/measured"]
    device.put(PedalState(0.5, False))
    graph.step(3)
    assert [(s.axes, s.buttons) for s in probe.samples["pedal/measured"]] == [((0.5,), (0,))] * 3
    for bad in (None, PedalState(2.0, False)):
        device.put(bad)
        graph.step()
        sample = probe.samples["pedal/measured"][-1]
        assert math.isnan(sample.axes[0]) and sample.buttons == (1,)


@pytest.mark.parametrize(
    ("action", "states"), [("QUICK_STOP", {"QUICK_STOP_ACTIVE"}), ("POWER_OFF", {"SWITCH_ON_DISABLED"})]
)
def test_the_action_of_the_heartbeat_decides_how_hard_the_robot_is_stopped(drives, action, states):
    drives.state("ENABLED")
    drives.move(SLOW, 5)
    drives.state("FAULT", action)
    drives.graph.step(80)
    assert {health.state.name for health in drives.node.driver.session.drives} == states
    drives.beat = "DISABLED NONE"
    drives.graph.step(20)
    assert drives.node.driver.stop.first is None and drives.node.driver.goal.name == "DISABLED"


@pytest.mark.parametrize("text", ["", "ENABLED", "ENABLED FASTER", "RUN NONE", "ENABLED NONE NONE", "x" * 1000])
def test_a_damaged_heartbeat_is_none(drives, text):
    drives.state("ENABLED")
    drives.move(SLOW, 5)
    drives.beat = text
    drives.move(SLOW, 20)
    assert drives.node.driver.stop.code.name == "SUPERVISOR_SILENT"


def test_a_dead_supervisor_stops_the_robot_and_its_return_enables_nothing(drives):
    drives.state("ENABLED")
    drives.move(SLOW, 5)
    drives.beat = ""
    drives.move(SLOW, 20)
    drives.beat = "ENABLED NONE"
    drives.move(SLOW, 20)
    assert not drives.node.driver.enabled
    assert drives.probe.samples["drives/setpoint_jv"][-1].velocity == (0.0,) * 5
