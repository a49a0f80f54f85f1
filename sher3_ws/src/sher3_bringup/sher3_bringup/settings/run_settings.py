"""What a run can be told, validated once before anything starts."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator
from sher3_common.namespace import robot_name
from sher3_control.settings import ControlSettings, MotionSettings
from sher3_description import Robot, load_robot
from sher3_drivers.name_plates import load_name_plates
from sher3_drivers.settings import MotorDriverSettings, default_settings

from sher3_bringup.errors import ConfigurationError
from sher3_bringup.settings.patience import CONTROL, DRIVES, Patience, drives_in

if TYPE_CHECKING:
    from sher3_faults.budget import TravelBudget

NODES = (
    "plant",
    "force_sensor",
    "pedal",
    "admittance",
    "kinematics",
    "motor_driver",
    "supervisor",
    "recorder",
    "gap_monitor",
)
LOOP = ("force_sensor", "pedal", "admittance", "kinematics", "motor_driver")
"""Nodes between the devices and the drives: with `--layout composed` they share a process, in this order."""
UNHURRIED = frozenset({"recorder", "gap_monitor"})
"""Nodes that compress and compute for milliseconds at a time."""
Layout = Literal["separate", "composed"]
MOCK_ONLY = frozenset({"plant"})
ON_REQUEST = frozenset({"gap_monitor"})
RATES = (100, 1000)
"""Lowest and highest control rate [Hz]."""
MOCK_FORCE_PORT = 7640
"""DDS takes 7400 + 250 * domain and the first hundred or two behind it."""
NETFT_PORT = 49152


class RunSettings(BaseModel):
    """One run of the graph.

    Attributes:
        mock: drives, sensor and pedal are emulated by the plant process.
        rate: control rate [Hz]; sets `control_period` of the robot.
        processes: node names, grouped into processes.
        robot_path: robot file, or None for the nominal one.
        drives_path: file of the drives' name plates (`sher3.drives/1`): others are refused at the start.
        effects: file of effects for the plant.
        links: CAN link per channel, as `socketcan:can0`; by default local ones of this run.
        record: folder of the recorded run.
        recording: `required`: the robot stops when its recorder dies or its disk is full; `optional`: it goes on,
            and `/diagnostics` says so.
        duration: seconds until the run ends by itself, or None.
        domain: ROS domain id.
        other_hosts: talk to other machines; by default everything stays on the loopback interface.
        realtime: SCHED_FIFO priority of every process, 0 for none, -1 for the default where the user may.
        force_device: address of the force sensor on the real robot, host or host:port.
        pedal_device: raw HID device of the pedal on the real robot.
        patience: time limits in force, see `patience`; the real robot has only the strict ones.
        exchange: the plant takes other effects while it runs; it then knows the library from the start.
        seed: of the plant's noise.
        near_speed, free_speed: speed caps of the two regimes [m/s], or None for those of the control settings; the
            caps of turning go with them.
        regime: speed regime at the start, see `sher3_control.motion.speed_cap`; by default `bench` on mocks, where
            nobody is near the tool, and `free` on the real robot.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    mock: bool = True
    rate: Annotated[float, Field(ge=RATES[0], le=RATES[1])] = 500.0
    processes: tuple[tuple[str, ...], ...] = ()
    robot_path: Path | None = None
    drives_path: Path | None = None
    effects: Path | None = None
    exchange: bool = False
    links: tuple[str, ...] = ()
    record: Path | None = None
    recording: Literal["required", "optional"] = "required"
    duration: Annotated[float, Field(gt=0.0)] | None = None
    domain: Annotated[int, Field(ge=0, le=231)] = 0
    other_hosts: bool = False
    realtime: Annotated[int, Field(ge=-1, le=90)] = 0
    force_device: str = ""
    pedal_device: str = ""
    patience: Patience = "strict"
    seed: Annotated[int, Field(ge=0)] = 0
    near_speed: Annotated[float, Field(gt=0.0, le=0.05)] | None = None
    free_speed: Annotated[float, Field(gt=0.0, le=0.05)] | None = None
    regime: Literal["", "near_tissue", "free", "bench"] = ""

    @model_validator(mode="after")
    def _consistent(self) -> RunSettings:
        objection = self._objection_to_processes() or self._objection_to_real_robot()
        if objection:
            raise ValueError(objection)
        return self

    def _objection_to_processes(self) -> str:
        """Return what is wrong with the nodes and their processes, empty when nothing is."""
        if unknown := [name for name in self.names if name not in NODES]:
            return f"unknown node {unknown[0]}; known: {', '.join(NODES)}"
        if twice := [name for name in self.names if self.names.count(name) > 1]:
            return f"node {twice[0]} is named twice"
        if any({"plant", "motor_driver"} <= set(process) for process in self.processes):
            return "plant and motor_driver wait for each other on the CAN link; give each a process"
        if any("supervisor" in process and len(process) > 1 for process in self.processes):
            return "the supervisor watches the others and must not end or wait with them; give it a process of its own"
        if any(UNHURRIED & set(process) and set(process) & set(LOOP) for process in self.processes):
            return "recorder and gap_monitor would hold up the nodes of the loop; give them another process"
        if self.record is None and "recorder" in self.names:
            return "the recorder needs --record FOLDER"
        return ""

    def _objection_to_real_robot(self) -> str:
        """Return what a run on the real robot lacks, or has that belongs to mocks; empty on mocks."""
        if self.mock:
            return ""
        if mocks := MOCK_ONLY & set(self.names):
            return f"{', '.join(mocks)} is for mocks only; leave it out or use --mock"
        if self.effects:
            return "effects change the plant, and a real robot has none; use --mock"
        if self.patience != "strict":
            return f"{self.patience} time limits are for mocks only; the real robot keeps the strict ones"
        if not self.links:
            return "the real robot needs --can, one link per channel, as socketcan:can0"
        if "force_sensor" in self.names and not self.force_device:
            return "the real robot needs --force-device, the address of its force sensor"
        if "pedal" in self.names and not self.pedal_device:
            return "the real robot needs --pedal-device, as /dev/hidraw0"
        if self.pedal_device.startswith("/dev/input/"):
            return f"{self.pedal_device} tells changes only, so a dead pedal looks held; use its /dev/hidraw device"
        return ""

    @property
    def names(self) -> tuple[str, ...]:
        """Every node of the run."""
        return tuple(name for process in self.processes for name in process)

    def force_address(self) -> tuple[str, int]:
        """Return host and port of the force sensor; the mock's port lies in the domain's own block of DDS ports."""
        if self.mock:
            return loopback_address(robot_name()), MOCK_FORCE_PORT + 250 * self.domain
        host, _, port = self.force_device.partition(":")
        return host, int(port or NETFT_PORT)

    def mock_name(self) -> str:
        """Return the name that the devices of this robot's mocks go by."""
        return f"{robot_name()}-{self.domain}"

    def robot(self) -> Robot:
        """Return the robot with the control period of this run."""
        robot = load_robot(self.robot_path)
        return robot.model_copy(update={"control_period": 1.0 / self.rate})

    def load_effects(self) -> list[Any]:
        """Return the effects of the plant, checked against the robot."""
        if self.effects is None:
            return []
        from sher3_effects import load_effects
        from sher3_sim import with_effects

        effects = load_effects(self.effects)
        with_effects(self.robot(), effects)
        return effects

    def drives(self) -> MotorDriverSettings:
        """Return the motor driver's settings: CAN channels that can carry the rate."""
        settings = default_settings(1.0 / self.rate, self.links or None)
        if not self.links:
            links = tuple(f"local:{self.mock_name()}/{i}" for i in range(len(settings.channels)))
            settings = default_settings(1.0 / self.rate, links)
        settings = drives_in(self.robot(), self.control().motion, settings)
        patient = DRIVES if self.patience != "strict" else {}
        plates = () if self.drives_path is None else load_name_plates(self.drives_path)
        identities = [plate.model_dump() for plate in plates]
        return MotorDriverSettings.checked(**{**settings.model_dump(), **patient, "identities": identities})

    def control(self) -> ControlSettings:
        """Return the settings of the control nodes."""
        overrides = CONTROL if self.patience == "patient" else {}
        motion = {**overrides.get("motion", {}), "regime": self.start_regime, **self._caps()}
        return ControlSettings.from_robot(self.robot(), {**overrides, "motion": motion})

    @property
    def start_regime(self) -> str:
        """The speed regime at the start."""
        return self.regime or ("bench" if self.mock else "free")

    def _caps(self) -> dict[str, float]:
        """Return the overrides of the speed caps; a turn is capped as the speed is."""
        defaults, caps = MotionSettings(), {}
        for name, speed in (("near", self.near_speed), ("free", self.free_speed)):
            if speed is not None:
                usual: float = getattr(defaults, f"{name}_speed")
                caps[f"{name}_speed"] = speed
                caps[f"{name}_turning"] = getattr(defaults, f"{name}_turning") * speed / usual
        return caps

    def budget(self) -> TravelBudget:
        """Return how far the tip may travel after each fault with these settings."""
        from sher3_faults.budget import TravelBudget

        return TravelBudget(self.robot(), self.control(), self.drives())


def loopback_address(name: str) -> str:
    """Return an address of the loopback network (127/8) of a robot's own, so that robots of a domain share no port."""
    return "127.0.0.1" if name == "sher3" else ".".join(map(str, (127, *hashlib.sha256(name.encode()).digest()[:3])))


def parse_processes(
    text: str | None,
    mock: bool,
    record: bool,
    monitor: bool = False,
    layout: Layout = "separate",
    without: Sequence[str] = (),
) -> tuple[tuple[str, ...], ...]:
    """Return the nodes of each process from `a+b,c` (a and b in one process); without a text all nodes in a `layout`.

    `separate` means one process for each node, `composed` one for the nodes of the loop. `monitor` adds
    the gap monitor in a process of its own, unless the text names it.

    Raises:
        ConfigurationError: a node that is to be left out is not there.
    """
    processes = _processes(text, mock, record, monitor, layout)
    names = [name for process in processes for name in process]
    if absent := [name for name in without if name not in names]:
        raise ConfigurationError(
            "no such node to leave out", value=absent[0], limit=", ".join(names), remedy="name one of these"
        )
    kept = (tuple(name for name in process if name not in without) for process in processes)
    return tuple(process for process in kept if process)


def _processes(
    text: str | None, mock: bool, record: bool, monitor: bool, layout: Layout
) -> tuple[tuple[str, ...], ...]:
    watch = (("gap_monitor",),) if monitor and "gap_monitor" not in (text or "") else ()
    if text:
        return tuple(tuple(name.strip() for name in process.split("+")) for process in text.split(",")) + watch
    skip = {*ON_REQUEST, *(() if mock else MOCK_ONLY), *(() if record else ("recorder",))}
    loop = LOOP if layout == "composed" else ()
    others = tuple((name,) for name in NODES if name not in {*skip, *loop})
    return (*((loop,) if loop else ()), *others, *watch)


def checked(**options: object) -> RunSettings:
    """Return validated settings of a run, and check that the CAN channels carry its rate.

    Raises:
        ConfigurationError: an option is out of range, unknown, or contradicts another.
        BudgetExceeded: after some fault the tip would travel farther than its regime allows; not asked on the bench.
        Sher3Error: the robot file or the CAN layout is invalid.
    """
    try:
        settings = RunSettings.model_validate(options)
    except ValidationError as error:
        details = [(".".join(map(str, e["loc"])), str(e["msg"]).removeprefix("Value error, ")) for e in error.errors()]
        what = "; ".join(f"{where}: {message}" if where else message for where, message in details)
        raise ConfigurationError(what, remedy="see 'sher3 up --help'") from None
    settings.robot()
    settings.drives().budgets()
    settings.load_effects()
    if settings.start_regime != "bench":
        settings.budget().require()
    return settings
