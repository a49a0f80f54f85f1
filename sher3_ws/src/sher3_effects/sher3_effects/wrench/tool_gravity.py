"""Tool gravity: the tool weighs more or less than the model says."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from sher3_common.numbers.cross import skew
from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.page import Page, Part, Tolerated, Values
from sher3_effects.sensor_view import SensorView
from sher3_effects.view import RobotView


class ToolGravity(Page):
    """reading += mass * g turned into {f}, at the centre of mass (and its shift)."""

    id, family, stage = "tool_gravity", "wrench", "sensing"
    inputs = ("posture",)
    seen_at = (("sensing", "force_sensor"),)
    breaks = "force_sensor"
    best = Best("loads", "known loads in several orientations separate bias, weight and cross-talk")
    places = ("force_sensor",)
    gives = ("mass", "com_x", "com_y", "com_z")
    tried = ({"free_com": 0.0}, {"free_com": 1.0})
    """At the nominal centre of mass, or with a first moment of its own."""
    explanation = (
        "What the sensor reads of the tool's weight is off: the error turns with roll and tilt exactly as gravity does."
    )
    siblings = {"force_bias": "does not turn", "cable_drag": "turns, but lags behind the motion"}
    units = {"com_x": "kg*m", "com_y": "kg*m", "com_z": "kg*m"}

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Weight per kilogram; with a free centre also the first moment."""
        unit = view.path.tool_wrench / view.robot.force_sensor.tool_mass
        if not shape["free_com"]:
            return Signature({Channel("sensing", site): unit[:, :, None]})
        columns = np.zeros((len(unit), 6, 4))
        columns[:, :3, 0] = unit[:, :3]
        columns[:, 3:, 1:] = -skew(unit[:, :3])
        return Signature({Channel("sensing", site): columns})

    def tolerated(self, robot: Robot, site: str) -> Sequence[Tolerated]:
        """Return the mass of the tool."""
        return (Tolerated({"free_com": 0.0}, {"tool mass": (robot.tolerances.tool_mass, "kg")}),)

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return the first moment beyond that of the mass as a shift of the centre of mass."""
        mass = robot.force_sensor.tool_mass + values["mass"]
        shift = {a: values.get(f"com_{a}", 0.0) / mass for a in "xyz"} if mass > 0.0 else {}
        return [Part(self.id, actuator, {"mass": values["mass"], **shift})]


class SensorLoad(Page):
    """A load on any force sensor: reading += mass * g turned into the sensor, at its centre of mass."""

    id, family, stage, best = ToolGravity.id, ToolGravity.family, ToolGravity.stage, ToolGravity.best
    kinds, places, needs = ("sensor",), ToolGravity.places, ("orientation",)
    gives = ToolGravity.gives
    inputs, explanation = ToolGravity.inputs, "What hangs on the sensor weighs more, or elsewhere, than stated."
    siblings = {"force_bias": "does not turn", "force_scale": "in proportion to everything the sensor reads"}
    units = {"mass": "kg", **ToolGravity.units}

    def shapes(self, views: Sequence[SensorView], site: str) -> list[Shape]:
        """Return one shape: it holds the stated mass, kg, which bounds what may be missing."""
        return [{"stated": views[0].mass}]

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether a load is left, the stated mass and the first of (4,) [kg] together: none is below zero."""
        return bool(shape["stated"] + coefficients[0] >= 0.0)

    def signature(self, view: SensorView, site: str, shape: Shape) -> Signature:
        """Return four columns: the weight per kilogram, and its moment per kilogram and metre along each axis."""
        columns = np.zeros((len(view.gravity), 6, 4))
        columns[:, :3, 0] = view.gravity
        columns[:, 3:, 1:] = -skew(view.gravity)
        return Signature({Channel(self.stage, site): columns})

    def in_words(self, view: SensorView, values: Mapping[str, float]) -> str:
        """Return the load as it was found."""
        return f"found: {view.load_in_words(values['mass'], [values[f'com_{x}'] for x in 'xyz'])}"


@dataclass(frozen=True)
class ToolGravityInPlant(PlantEffect, page=ToolGravity):
    """The tool outboard of the sensor is heavier than thought, or its centre of mass lies elsewhere."""

    mass: float = parameter("kg", 5e-3, -0.02, 0.5, "tool mass less nominal")
    x: float = parameter("m", 0.0, -0.1, 0.1, "centre of mass less nominal, along x of {f}")
    y: float = parameter("m", 0.0, -0.1, 0.1, "centre of mass less nominal, along y of {f}")
    z: float = parameter("m", 0.0, -0.1, 0.1, "centre of mass less nominal, along z of {f}")

    def apply(self, p: PlantParameters) -> None:
        """Change the tool's weight."""
        p.body["tool_mass"] += self.mass
        p.body["tool_com"][0] += (self.x, self.y, self.z)
