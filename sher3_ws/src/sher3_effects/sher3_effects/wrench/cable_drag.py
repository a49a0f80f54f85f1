"""Cable drag: a pull that depends on the pose and lags behind the motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column
from sher3_sim.effect import PlantEffect, parameter
from sher3_sim.parameters import PlantParameters

from sher3_effects.compliance.two_slopes import BENT_FROM
from sher3_effects.page import Page, Part, Values
from sher3_effects.travel import over_travel, share_of
from sher3_effects.view import RobotView

AT_SENSOR = 6
"""Coefficients from which a cable is one at the sensor, three components by roll and by tilt; an axis has five."""


class CableDrag(Page):
    """On an axis: k q + k0 + hysteresis over a long stroke; on the force sensor: the same of roll and tilt (as
    angles), per component. A cable on an axis may pull the harder the more it is bent: `stiffness` is then the mean.
    One that is not held at the sensor's origin turns it as well (`lever`): torques follow the same.

    On an axis a cable pulls back and drags: k and the hysteresis have no sign. Its pull at rest k0 may have either, and
    so has each component at the force sensor: it depends on which way the cable hangs.
    """

    id, family, stage = "cable_drag", "wrench", "motor_mechanics"
    inputs = ("position", "direction", "posture")
    best = Best("loads", "known loads in several orientations separate bias, weight and cross-talk")
    leaves_out = "how it stiffens"
    bent_from = BENT_FROM
    places = ("axis", "force_sensor")
    extends = ("gravity_load", "presliding_friction")
    explanation = (
        "A cable or tube pulls: the force changes smoothly with the pose and differs a little between the two "
        "directions."
    )
    siblings = {
        "gravity_load": "in proportion to weight",
        "presliding_friction": "saturates within a short stroke",
        "tool_gravity": "turns with the tool exactly as weight does",
    }
    units = {"preload": "N"}
    polished = ("stroke",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """On the force sensor it is a matter of sensing."""
        return (Channel("sensing", site),) if site == "force_sensor" else super().channels(site)

    def stage_at(self, channel: Channel) -> str:
        """Return the stage of the site: motor mechanics of an axis, sensing of the force sensor."""
        return channel.stage

    def shapes(self, views: Sequence[RobotView], site: str) -> list[Shape]:
        """Stroke over which the hysteresis turns, in motor revolutions (0: none)."""
        return [{"stroke": 0.0}, {"stroke": 0.25}, {"stroke": 1.0}]

    def bends(self, views: Sequence[RobotView], site: str, shape: Shape) -> list[Shape]:
        """Return the cable on an axis that hardens; at the sensor, one that pulls beside its origin."""
        return [{**shape, "lever": 1.0}] if site == "force_sensor" else over_travel(views, site, shape)

    def signature(self, view: RobotView, site: str, shape: Shape) -> Signature:
        """Offset, stiffness and, with a stroke, hysteresis; of a cable that hardens square and cube of the place."""
        if site == "force_sensor":
            return self._sensor(view, shape)
        axis = view.row(site)
        q = view.position[:, axis]
        parts = [np.ones_like(q), q]
        if shape["stroke"]:
            parts.append(view.run.to_grid(view.sliding(axis, shape["stroke"] * view.lead(site))))
        if "half" in shape:
            x = share_of(q, shape)
            parts += [x**2, x**3 - 0.6 * x]
        return Signature({Channel(self.stage, site): column(*parts)})

    def _sensor(self, view: RobotView, shape: Shape) -> Signature:
        radius = view.robot.tilt_linkage.crank
        drives = [view.position[:, 3], view.position[:, 4] / radius]
        if shape["stroke"]:
            drives += [
                view.run.to_grid(view.sliding(axis, shape["stroke"] * view.robot.actuators[axis].lead))
                for axis in (3, 4)
            ]
        pulled = _pulled(shape)
        columns = np.zeros((len(drives[0]), 6, pulled * len(drives)))
        for j, drive in enumerate(drives):
            columns[:, range(pulled), range(pulled * j, pulled * (j + 1))] = drive[:, None]
        return Signature({Channel("sensing", "force_sensor"): columns})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return preload, stiffness and force of hysteresis, (p,); on the force sensor the largest component.

        There the stiffness is in N per rad.
        """
        if len(coefficients) >= AT_SENSOR:
            forces = np.abs(coefficients.reshape(-1, _pulled(shape))[:, :3])
            out = {"stiffness": float(forces[:2].max())}
            return {**out, "force": float(forces[2:].max())} if shape["stroke"] else out
        preload, stiffness, *rest = map(float, coefficients)
        out = {"preload": preload, "stiffness": stiffness}
        return {**out, "force": rest[0]} if shape["stroke"] else out

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether a cable (p,) on an axis pulls back everywhere, never softens, and drags.

        On the force sensor its pull may have any sign.
        """
        if len(coefficients) >= AT_SENSOR:
            return True
        if "half" not in shape:
            return bool((coefficients[1:] >= 0.0).all())
        *bare, square, cube = coefficients[1:]
        x = np.linspace(-1.0, 1.0, 21)
        slope = bare[0] * shape["half"] + 2.0 * square * x + cube * (3.0 * x**2 - 0.6)
        return bool(min(*bare, cube) >= 0.0 and (slope >= 0.0).all())

    def unit(self, name: str, site: str, rotary: bool) -> str:
        """A stiffness is per angle on the force sensor."""
        return "N/rad" if site == "force_sensor" and name == "stiffness" else super().unit(name, site, rotary)

    def to_simulator(self, actuator: str, values: Values, robot: Robot) -> list[Part]:
        """Return spring and drag, which turns over the plant's own stroke; the plant's cable has no preload."""
        return [Part(self.id, actuator, {name: values.get(name, 0.0) for name in ("stiffness", "force")})]


def _pulled(shape: Shape) -> int:
    """Return the number of components of the force sensor that a cable pulls at: forces, and torques with a lever."""
    return 6 if "lever" in shape else 3


@dataclass(frozen=True)
class CableDragInPlant(PlantEffect, page=CableDrag):
    """A cable pulls back, as a spring along the travel and a hysteretic drag; on an axis or on the force sensor."""

    stiffness: float = parameter("N/m", 20.0, 0.0, 5000.0, "force per displacement")
    force: float = parameter("N", 0.1, 0.0, 20.0, "hysteretic part")
    displacement: float = parameter("m", 1e-3, 1e-6, 0.05, "over which the hysteretic part turns to 1/e")

    def apply(self, p: PlantParameters) -> None:
        """Attach the cable."""
        if self.actuator == "force_sensor":
            p.body["sensor_cable_stiffness"] += self.stiffness
            p.body["sensor_cable_force"] += self.force
            p.body["sensor_cable_displacement"] = self.displacement
        else:
            p.axis["cable_stiffness"][self.rows] += self.stiffness
            p.axis["cable_force"][self.rows] += self.force
            p.axis["cable_displacement"][self.rows] = self.displacement
