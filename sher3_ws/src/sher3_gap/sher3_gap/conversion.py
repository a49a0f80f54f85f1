"""What the library's parameters mean to the simulator, where the two describe an effect in other terms.

Each converter takes the fitted values and returns parts: (effect id, actuator, parameters by the simulator's names).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_kinematics.kernel import gravity_load_into, kernel_parameters

Values = Mapping[str, float]
Part = tuple[str, str, dict[str, float]]
SLIDERS = ACTUATORS[:3]
LINKAGE = ("crank", "length", "offset")
"""Members of the tilt linkage in the library's order, by the simulator's names (`length` is the coupler's)."""


def convert(effect: str, actuator: str, values: Values, robot: Robot) -> list[Part]:
    """Return the simulator's effects for one cause; unchanged where both speak the same language."""
    if effect in _CONVERTERS:
        return _CONVERTERS[effect](actuator, values, robot)
    return [(effect, actuator, dict(values))]


def _gravity_load(actuator: str, values: Values, robot: Robot) -> list[Part]:
    """Return the mass whose weight is missing: a share of the carried one, or a force at the centre."""
    row, arm = ACTUATORS.index(actuator), robot.arm
    carried = robot.delta.moving_mass if row < 3 else arm.tilt_mass + (arm.roll_mass if row == 3 else 0.0)
    if "relative" in values:
        return [("gravity_load", actuator, {"mass": values["relative"] * carried})]
    weight = np.zeros(5)
    gravity_load_into(kernel_parameters(robot), np.zeros(5), weight)
    if abs(weight[row]) < 1e-6:
        return [("gravity_load", actuator, {"mass": 0.0})]
    return [("gravity_load", actuator, {"mass": values["force"] / weight[row] * carried})]


def _crosstalk(actuator: str, values: Values, robot: Robot) -> list[Part]:
    free = {name: value for name, value in values.items() if len(name) == 2}
    if free:
        return [("force_crosstalk", actuator, free)]
    source, target = int(values["source"]), int(values["target"])
    return [("force_crosstalk", actuator, {"xyz"[target] + "xyz"[source]: values["coefficient"]})]


def _rail_tilt(actuator: str, values: Values, robot: Robot) -> list[Part]:
    lean = math.atan2(values["y"], values["x"]) - robot.delta.leg_azimuth[ACTUATORS.index(actuator)]
    return [("rail_tilt", actuator, {"angle": values["angle"], "azimuth": math.remainder(lean, 2.0 * math.pi)})]


def _platform(actuator: str, values: Values, robot: Robot) -> list[Part]:
    """Return radial and tangential offsets of one leg, or the same radius on all three."""
    if "radius" in values:
        return [("platform_geometry_error", a, {"x": values["radius"], "y": 0.0}) for a in SLIDERS]
    azimuth = robot.delta.leg_azimuth[ACTUATORS.index(actuator)]
    c, s = math.cos(azimuth), math.sin(azimuth)
    x, y = values["x"], values["y"]
    return [("platform_geometry_error", actuator, {"x": c * x + s * y, "y": c * y - s * x})]


def _linkage(actuator: str, values: Values, robot: Robot) -> list[Part]:
    """Return the member's error, beside an encoder offset where the axis has its own zero: the plant's is drawn."""
    member = LINKAGE[int(values.get("member", 1))]
    error: Part = ("tilt_linkage_error", actuator, {"length": 0.0, member: values["length"]})
    if values.get("drawn_zero", 1.0):
        return [error]
    drawn = robot.tilt_linkage
    built = {"crank": drawn.crank, "length": drawn.coupler, "offset": drawn.offset}
    built[member] += values["length"]
    reach = math.sqrt(built["length"] ** 2 - (built["offset"] - built["crank"]) ** 2)
    moved = math.sqrt(drawn.coupler**2 - (drawn.offset - drawn.crank) ** 2) - reach
    return [error, ("encoder_offset", actuator, {"offset": moved})]


def _tool_gravity(actuator: str, values: Values, robot: Robot) -> list[Part]:
    """Return the first moment beyond that of the mass as a shift of the centre of mass."""
    mass = robot.force_sensor.tool_mass + values["mass"]
    shift = {a: values.get(f"com_{a}", 0.0) / mass for a in "xyz"} if mass > 0.0 else {}
    return [("tool_gravity", actuator, {"mass": values["mass"], **shift})]


def _cable(actuator: str, values: Values, robot: Robot) -> list[Part]:
    drag = {"stiffness": values.get("stiffness", 0.0), "force": values.get("force", 0.0)}
    return [("cable_drag", actuator, drag)]


def _friction_drift(actuator: str, values: Values, robot: Robot) -> list[Part]:
    """Return f + d (1 - exp(-t / T)) as a constant level f + d and one of -d that decays."""
    constant, change = values["force"], values["drift"]
    if values["time_constant"] <= 0.0:
        return [("coulomb_friction", actuator, {"force": constant})]
    parts: list[Part] = [
        ("friction_drift", actuator, {"force": max(-change, 0.0), "time_constant": values["time_constant"]})
    ]
    level = constant + change
    return parts if level <= 0.0 else [*parts, ("coulomb_friction", actuator, {"force": level})]


def _position_friction(actuator: str, values: Values, robot: Robot) -> list[Part]:
    lead = robot.actuators[ACTUATORS.index(actuator)].lead
    return [("position_friction", actuator, {**values, "periods_per_rev": lead / values["wavelength"]})]


_CONVERTERS: dict[str, Callable[[str, Values, Robot], list[Part]]] = {
    "gravity_load": _gravity_load,
    "force_crosstalk": _crosstalk,
    "rail_tilt": _rail_tilt,
    "platform_geometry_error": _platform,
    "tilt_linkage_error": _linkage,
    "tool_gravity": _tool_gravity,
    "cable_drag": _cable,
    "friction_drift": _friction_drift,
    "position_friction": _position_friction,
}
