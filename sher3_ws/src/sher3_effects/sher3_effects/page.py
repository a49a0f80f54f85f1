"""What a page says beside the engine's data sheet: how its parameters enter the simulators."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import ClassVar, NamedTuple

from sher3_description import Robot
from sher3_diagnosis.channel import Array
from sher3_diagnosis.effect import ROTARY, Effect, Shape
from sher3_sim.effect import Parameter, PlantEffect

from sher3_effects.view import AxisView, NominalAxis

Values = Mapping[str, float]
"""Fitted parameters by name, SI units."""

TIP_POSE = (("mechanism", "tip"), ("structure", "tip"))
"""Where the pose of the tip is seen, free and loaded: see `Effect.seen_at`."""
NOWHERE: tuple[tuple[str, str], ...] = ()
"""Of an exact stage, which is judged without residuals."""

CONSTANTS: Mapping[str, str] = {
    "coulomb": "friction in motion",
    "static": "friction at rest",
    "stribeck": "speed over which the one falls to the other",
    "viscous": "viscous coefficient",
    "load_loss": "friction by the force that the joint carries",
    "offset": "constant force against the drive",
    "weight": "relative change of the weight",
    "arm": "largest weight of an axis that turns",
    "hanging": "position at which that weight hangs down",
    "drive": "relative change of the drive's force",
    "inertia": "mass or inertia on the joint",
    "delay": "dead time of the command",
    "servo": "relative change of all gains of the joint's servo",
    "servo_position": "relative change of its position gain",
    "servo_velocity": "relative change of its velocity gain",
    "servo_delay": "dead time of its reference",
    "lag": "time constant of the drive",
    "limit": "largest force of the drive",
    "zero": "reading less true position",
    "ratio": "relative change of load over motor travel",
    "cogging": "amplitude of a force that repeats with the joint's angle",
    "cogging_periods": "its periods per turn, or per 2 pi m",
    "cogging_phase": "its phase at zero",
    "backlash": "width of the gap between motor and load",
    "compliance": "displacement of the load per force",
    "spring": "stiffness of a spring that pulls to one position",
    "rest": "position at which that spring is relaxed",
    "link": "relative change of mass and inertia of a link",
    "link_mass": "change of the mass of a link",
    "link_mx": "change of its mass times centre along x of its joint",
    "link_my": "the same along y",
    "link_mz": "the same along z",
    "link_ixx": "change of its inertia about its joint, xx",
    "link_ixy": "the same, xy",
    "link_iyy": "the same, yy",
    "link_ixz": "the same, xz",
    "link_iyz": "the same, yz",
    "link_izz": "the same, zz",
    "payload": "mass of a body on a link",
    "payload_x": "its centre along x of the joint of the link",
    "payload_y": "its centre along y",
    "payload_z": "its centre along z",
    "shift_x": "shift of the joint along x of its frame",
    "shift_y": "shift of the joint along y of its frame",
    "shift_z": "shift of the joint along z of its frame",
    "noise_position": "noise of its position readings, standard deviation",
    "resolution_position": "their step",
    "noise_load": "noise of its second encoder, standard deviation",
    "resolution_load": "its step",
    "noise_effort": "noise of its effort readings, standard deviation",
    "resolution_effort": "their step",
}
"""Constants of the equation of motion of a joint, and of its readings, that a machine may have beyond its model, SI."""
NOISE = tuple(name for name in CONSTANTS if name.startswith(("noise", "resolution")))
"""Constants of a joint's readings."""


class Part(NamedTuple):
    """One effect of the plant: its id, where it sits, and its parameters by the plant's names."""

    effect: str
    actuator: str
    parameters: dict[str, float]


class Tolerated(NamedTuple):
    """How a page's effect may show on a healthy robot: in one shape, by so much for each coefficient.

    Attributes:
        shape: of the effect.
        limits: quantity as it is printed -> tolerance of its coefficient and unit, in the order of the columns.
    """

    shape: Shape
    limits: Mapping[str, tuple[float, str]]


class Hidden(NamedTuple):
    """A load behind the only encoder of an axis, of which nobody says how heavy it is.

    Attributes:
        mass: that is put behind the effect, kg or kg m^2.
        step: one count of the encoder, m or rad.
        units: of position and of force, as they are printed.
        shows: whether the effect would be seen in a shape.
    """

    mass: float
    step: float
    units: tuple[str, str]
    shows: Callable[[Shape], bool]


class Page(Effect):
    """One effect in a file of its own.

    Class attributes:
        plant: its form in the plant, which states unit, default and bounds of every parameter the plant takes; set by
            that form. None where the plant has none.
        source: the file of a discovered effect, which an effects file must name.
        breaks: which relation of the signal chain the effect breaks, where that is not the one named like its stage:
            "load_encoder", "both_encoders" or "force_sensor", the readings.
        on_axis: fitted parameter -> constant of `CONSTANTS` that it sets, beyond the nominal one.
        after_effort: whether it makes a force of the recorded effort, see `acting`.
        computed: the parameter that is read off a record without a fit, as in an exact stage; "" where there is none.
    """

    plant: ClassVar[type[PlantEffect] | None] = None
    source: ClassVar[Path | None] = None
    breaks: ClassVar[str] = ""
    on_axis: ClassVar[Mapping[str, str]] = {}
    computed: ClassVar[str] = ""
    after_effort: ClassVar[bool] = False

    def acting(self, given: Array, clock: Array, period: float, shape: Shape) -> Array:
        """Return the force (n,) that acts where an effort was recorded, with its stamps, s; by default that effort."""
        return given

    def on(self, axis: NominalAxis) -> Page:
        """Return the page with those constants of the axis that it needs; by default the page itself."""
        return self

    def at_estimate(self) -> Page:
        """Return the page with its computed parameter held, so that nothing is fitted; by default the page itself."""
        return self

    def least_shown(self, views: Sequence[AxisView], site: str, hidden: Hidden) -> str:
        """Return in words the least effect that one encoder would show; by default an empty text."""
        return ""

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return how the effect may show on a healthy robot, from its table of tolerances; by default empty."""
        return ()

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the effects of the plant that a fitted cause stands for; default this one with the same parameters.

        Args:
            actuator: site of the cause.
            values: its fitted parameters.
            robot: nominal model.
        """
        return [Part(self.id, actuator, dict(values))]

    @property
    def specification(self) -> Mapping[str, Parameter]:
        """The plant's parameters with their units and bounds on a linear axis."""
        return self.plant.specification(self.plant.sites[0]) if self.plant else {}

    def unit(self, name: str, site: str, rotary: bool) -> str:
        """Return the unit of a fitted parameter; of one that the page does not state, the plant's."""
        if name not in self.units and name in self.specification:
            found = self.specification[name]
            return ROTARY.get(found.unit, found.unit) if rotary and not found.fixed_unit else found.unit
        return super().unit(name, site, rotary)
