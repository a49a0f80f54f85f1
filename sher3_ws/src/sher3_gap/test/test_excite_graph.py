"""The player on the control graph in stepped time: what it plays is what the robot's host re-executes, tick by tick."""

import numpy as np
import pytest
from sher3_gap.excitation import excite
from simulated import ROBOT

pytestmark = pytest.mark.graph
T = 2_000_000


def robot_node():
    from rclpy.node import Node
    from sher3_common.samples import JointSample, JoySample, WrenchSample
    from sher3_runtime.ports import NODE_OPTIONS, advertise, on_tick, subscribe

    class IdealRobot(Node):
        """Integrates `servo_jv` exactly, with a released pedal and a free tip."""

        def __init__(self, **options):
            super().__init__("ideal_robot", **{**NODE_OPTIONS, **options})
            self.q, self.velocity, self.count = np.zeros(5), np.zeros(5), 0
            self.send = {t: advertise(self, t) for t in ("measured_js", "force/measured_cf", "pedal/measured")}
            subscribe(self, "servo_jv", lambda sample: setattr(self, "velocity", np.array(sample.velocity)))
            on_tick(self, self.tick)

        def tick(self, stamp):
            self.q = self.q + 0.002 * self.velocity
            self.count += 1
            weight = -ROBOT.force_sensor.tool_mass * 9.81
            self.send["measured_js"](JointSample(stamp, tuple(self.q.tolist())))
            self.send["pedal/measured"](JoySample(stamp, (0.0,), (0,)))
            wrench = (1e-6 * (self.count % 7), 0.0, weight, 0.0, 0.0, 0.0)
            self.send["force/measured_cf"](WrenchSample(stamp, wrench))

    return IdealRobot


def test_every_set_point_reaches_the_host_at_its_tick():
    from sher3_control.nodes.admittance_node import AdmittanceNode
    from sher3_control.nodes.kinematics_node import KinematicsNode
    from sher3_control.nodes.supervisor_node import SupervisorNode
    from sher3_control.settings import ControlSettings
    from sher3_gap.excitation.excite_node import ExciteNode
    from sher3_gap.excitation.player import Phase, Player
    from sher3_runtime import Graph

    excitation = excite("sweep", ROBOT, posture="p1", duration=2.0)
    with Graph(middleware=False) as graph:
        graph.add(robot_node())
        bench = ControlSettings.from_robot(ROBOT, {"motion": {"regime": "bench"}})
        for node in (SupervisorNode, KinematicsNode, AdmittanceNode):
            graph.add(node, ROBOT, bench)
        player = Player(excitation, ROBOT)
        node = graph.add(ExciteNode, player)
        probe = graph.probe("setpoint_js")
        for _ in range(40):
            graph.step(100)
            if node.finished:
                break
        assert node.failure is None
        assert player.phase is Phase.DONE
        heard = {s.stamp: s for s in probe.samples["setpoint_js"]}
    stamps = [player.first + k * T for k in range(len(excitation.position))]
    assert all(stamp in heard for stamp in stamps)
    assert np.allclose([heard[s].position for s in stamps], excitation.position, atol=1e-15)
    assert np.allclose([heard[s].velocity for s in stamps], excitation.velocity, atol=1e-15)
