"""How each node of a run is made from its settings; each is imported only by who runs it."""

from __future__ import annotations

import gc
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

from sher3_bringup.processes.warm import warm_up
from sher3_bringup.settings.patience import PEDAL_AGE
from sher3_bringup.settings.run_settings import RunSettings

PARAMETER_EVENT = "rcl_interfaces/msg/ParameterEvent"
"""Type that every rclpy node publishes besides its own topics."""

Factory = Callable[[RunSettings], Any]


def make_nodes(settings: RunSettings, names: Sequence[str]) -> list[Any]:
    """Return the nodes of one process, in the order of `names`."""
    return [_FACTORIES[name](settings) for name in names]


def preload(settings: RunSettings, names: Sequence[str]) -> None:
    """Import and compile what these nodes of the run need, once, before their processes are forked."""
    from sher3_description import TOPICS
    from sher3_runtime.codec.messages import message_class

    gc.disable()
    for kind in {PARAMETER_EVENT, *(topic.type for topic in TOPICS.values())}:
        type(message_class(kind)).__import_type_support__()  # rclpy would do it in each process, with all of its parser
    for name in names:
        import_module(_MODULES[name])
    warm_up(settings.robot(), names)
    # The processes share these pages until somebody writes into them, and a collection writes into every object.
    gc.freeze()
    gc.enable()


_MODULES = {
    "plant": "sher3_sim.plant_node",
    "force_sensor": "sher3_drivers.sensor.force_sensor_node",
    "pedal": "sher3_drivers.pedal.pedal_node",
    "admittance": "sher3_control.nodes.admittance_node",
    "kinematics": "sher3_control.nodes.kinematics_node",
    "motor_driver": "sher3_drivers.drive.motor_driver_node",
    "supervisor": "sher3_control.nodes.supervisor_node",
    "recorder": "sher3_bags.recording.recorder_node",
    "gap_monitor": "sher3_gap.live.gap_monitor_node",
}


def _force_sensor(settings: RunSettings) -> Any:
    from sher3_drivers.sensor.force_sensor_node import ForceSensorNode
    from sher3_drivers.sensor.netft import NetFtSensor
    from sher3_runtime.ports import context_clock

    return ForceSensorNode(settings.robot(), NetFtSensor(settings.force_address(), context_clock().now))


def _pedal(settings: RunSettings) -> Any:
    from sher3_drivers.pedal.hid import HidPedal
    from sher3_drivers.pedal.pedal_node import PedalNode

    device = _mock_pedal(settings) if settings.mock else HidPedal(settings.pedal_device)
    return PedalNode(settings.robot(), device)


def _mock_pedal(settings: RunSettings) -> Any:
    from sher3_drivers.pedal.local import LocalPedal

    return LocalPedal(settings.mock_name(), PEDAL_AGE[settings.patience])


def _admittance(settings: RunSettings) -> Any:
    from sher3_control.nodes.admittance_node import AdmittanceNode

    return AdmittanceNode(settings.robot(), settings.control())


def _kinematics(settings: RunSettings) -> Any:
    from sher3_control.nodes.kinematics_node import KinematicsNode

    return KinematicsNode(settings.robot(), settings.control())


def _motor_driver(settings: RunSettings) -> Any:
    from sher3_drivers.drive.motor_driver_node import MotorDriverNode

    return MotorDriverNode(settings.robot(), settings.drives())


def _supervisor(settings: RunSettings) -> Any:
    from sher3_control.nodes.supervisor_node import SupervisorNode

    return SupervisorNode(settings.robot(), settings.control())


def _recorder(settings: RunSettings) -> Any:
    from sher3_bags.recording.recorder_node import RecorderNode
    from sher3_bags.run import RunMetadata

    assert settings.record is not None, "checked by the settings"
    metadata = RunMetadata(
        excitation="session",
        origin="plant" if settings.mock else "robot",
        seed=settings.seed if settings.mock else None,
    )
    parameters = settings.model_dump(mode="json", exclude_defaults=True)
    required = settings.recording == "required"
    return RecorderNode(settings.record, settings.robot(), metadata=metadata, parameters=parameters, required=required)


def _plant(settings: RunSettings) -> Any:
    from sher3_drivers.sensor.netft_server import NetFtServer
    from sher3_effects import plants
    from sher3_effects.effects_file import effects_from_text
    from sher3_faults.injector import FaultInjector
    from sher3_sim.plant_node import PlantNode

    if settings.exchange:
        plants()  # read now: the robot would stop while the plant reads the library
    return PlantNode(
        settings.robot(),
        settings.drives(),
        settings.load_effects(),
        settings.seed,
        force_device=NetFtServer(settings.force_address()),
        pedal_device=settings.mock_name(),
        faults=FaultInjector,
        effects_of=effects_from_text if settings.exchange else None,
    )


def _gap_monitor(settings: RunSettings) -> Any:
    from sher3_gap.live.gap_monitor_node import GapMonitorNode

    return GapMonitorNode(settings.robot())


_FACTORIES: dict[str, Factory] = {
    "plant": _plant,
    "force_sensor": _force_sensor,
    "pedal": _pedal,
    "admittance": _admittance,
    "kinematics": _kinematics,
    "motor_driver": _motor_driver,
    "supervisor": _supervisor,
    "recorder": _recorder,
    "gap_monitor": _gap_monitor,
}
