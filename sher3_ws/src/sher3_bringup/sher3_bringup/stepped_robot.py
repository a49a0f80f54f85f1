"""The whole robot on mocks in one process and in stepped time: every node, the CAN frames and all topics."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import partial
from typing import Any

from sher3_control.nodes.admittance_node import AdmittanceNode
from sher3_control.nodes.kinematics_node import KinematicsNode
from sher3_control.nodes.supervisor_node import SupervisorNode
from sher3_control.settings import ControlSettings
from sher3_description import Robot, load_robot
from sher3_drivers.bus.link import CanLink, open_link
from sher3_drivers.bus.lockstep import LockstepLink
from sher3_drivers.canopen.other_host import LISTEN
from sher3_drivers.drive.motor_driver_node import MotorDriverNode
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.pedal.pedal_node import PedalNode
from sher3_drivers.sensor.device import InProcessForceSensor
from sher3_drivers.sensor.force_sensor_node import ForceSensorNode
from sher3_drivers.settings import MotorDriverSettings, default_settings
from sher3_faults.injector import FaultInjector
from sher3_runtime import Graph
from sher3_runtime.composed.composition import Composition
from sher3_sim import PlantEffect
from sher3_sim.plant_node import PlantNode
from sher3_sim.scatter import RunScatter

from sher3_bringup.settings.patience import drives_in

_numbers = itertools.count()


class SteppedRobot:
    """Every node of `sher3 up` but the recorder, in one `Graph`.

    The speed regime is the bench unless `control` says another. The motor driver's limits are those of that regime, as
    in `sher3 up`, unless `drives` are given: who measures the strict limits gives `default_settings(period)`. With
    `composed` the nodes of the loop share a process, as in `sher3 up --layout composed`.

    Attributes:
        graph: the graph; `force` and `pedal_device`: the device ends; the nodes by their names.
    """

    def __init__(
        self,
        graph: Graph,
        effects: Sequence[PlantEffect] = (),
        seed: int = 1,
        robot: Robot | None = None,
        control: ControlSettings | None = None,
        scatter: RunScatter | None = None,
        drives: MotorDriverSettings | None = None,
        composed: bool = False,
    ) -> None:
        robot = robot or load_robot()
        control = control or ControlSettings.from_robot(robot, {"motion": {"regime": "bench"}})
        self.graph, self.robot, self.control = graph, robot, control
        self.force, self.pedal_device = InProcessForceSensor(), InProcessPedal(clock=graph.clock.now)
        settings = drives or drives_in(robot, control.motion, default_settings(robot.control_period))
        channel = f"stepped{next(_numbers)}"
        count = len(settings.channels)
        device_ends, host_ends = ([open_link(f"virtual:{channel}-{i}") for i in range(count)] for _ in range(2))
        devices = {"force_device": self.force, "pedal_device": self.pedal_device, "faults": FaultInjector}
        together = Composition() if composed else None
        add = graph.add if together is None else partial(graph.add_to, together)
        self.plant = graph.add(PlantNode, robot, settings, effects, seed, scatter, device_ends, **devices)
        self._settings, self._channel = settings, channel
        self.motor_driver = add(MotorDriverNode, robot, settings, self._lockstep(host_ends))
        self.force_sensor = add(ForceSensorNode, robot, self.force)
        self.pedal = add(PedalNode, robot, self.pedal_device)
        self.supervisor = graph.add(SupervisorNode, robot, control)
        self.kinematics = add(KinematicsNode, robot, control)
        self.admittance = add(AdmittanceNode, robot, control)

    def _lockstep(self, links: Sequence[CanLink]) -> list[LockstepLink]:
        return [LockstepLink(link, [self.plant.drives.poll]) for link in links]

    def start_again(self, name: str) -> Any:
        """Start the process of a node a second time, at the same devices and on the same buses; return the new node.

        Raises:
            Sher3Error: it refuses to start.
        """
        if name == "motor_driver":
            links = [open_link(f"virtual:{self._channel}-{i}") for i in range(len(self._settings.channels))]
            self.graph.step(round(LISTEN / self.robot.control_period))  # it listens first, and that takes time
            return self.graph.add(MotorDriverNode, self.robot, self._settings, self._lockstep(links))
        devices = {"force_sensor": (ForceSensorNode, self.force), "pedal": (PedalNode, self.pedal_device)}
        if name in devices:
            kind, device = devices[name]
            return self.graph.add(kind, self.robot, device)
        law = {"supervisor": SupervisorNode, "kinematics": KinematicsNode, "admittance": AdmittanceNode}
        return self.graph.add(law[name], self.robot, self.control)
