"""The catalogue of standard excitations: names, purposes and what each tells apart."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np
from sher3_description import Robot

from sher3_gap.excitation import standard
from sher3_gap.excitation.excitation import Excitation, ExcitationError, check_limits

POSTURES: dict[str, tuple[float, float, float, float, float]] = {
    "p0": (0.0, 0.0, 0.0, 0.0, 0.0),
    "p1": (0.0022, -0.0012, 0.0014, 0.22, 0.0032),
    "p2": (-0.0016, 0.0024, 0.0006, -0.24, -0.0034),
    "p3": (0.0028, 0.0031, 0.0029, 0.1, -0.0021),
}
"""Start postures, actuator units: centre, two opposite ones, one that is high with little roll."""


@dataclass(frozen=True)
class Entry:
    """One standard excitation: what it is for and which effects it tells apart (`a / b / c`)."""

    name: str
    purpose: str
    separates: tuple[str, ...]
    motion: standard.MotionFunction
    loads: standard.LoadFunction = standard.no_loads
    smooth: bool = True


_ENTRIES = (
    Entry(
        "reversals",
        "Stick, pre-sliding and slip: reversals of growing size with dwell, ten micrometres to a millimetre",
        (
            "coulomb_friction / presliding_friction / stribeck_friction",
            "backlash / transmission_hysteresis / transmission_compliance",
            "velocity_deadband / coulomb_friction",
        ),
        standard.reversals,
    ),
    Entry(
        "sweep",
        "Speed and position: out and back at four constant speeds over more than a motor revolution",
        (
            "viscous_friction / coulomb_friction / stribeck_friction",
            "cogging / position_friction",
            "transmission_ripple / encoder_eccentricity / lead_error",
        ),
        standard.sweep,
    ),
    Entry(
        "steps",
        "Time and inertia: moves of many sizes at the acceleration and velocity limits",
        (
            "command_delay / drive_lag / command_jitter",
            "payload_mass / torque_constant",
            "force_saturation / drive_lag",
            "structural_vibration / tool_bending",
        ),
        standard.steps,
    ),
    Entry(
        "loads",
        "Stiffness and the wrench chain: known loads at the tip in six directions, the robot holding still",
        (
            "structural_compliance / link_compliance / tool_bending",
            "transmission_compliance / backlash",
            "force_scale / force_bias / force_crosstalk",
            "torque_constant / gravity_load",
        ),
        standard.hold,
        standard.load_plateaus,
    ),
    Entry(
        "postures",
        "Geometry and gravity: wide moves between postures, each reached from both sides",
        (
            "link_length_error / platform_geometry_error / rail_tilt / base_tilt",
            "tool_offset / encoder_offset / tilt_linkage_error",
            "tool_gravity / force_bias / cable_drag",
            "joint_clearance / link_length_error",
        ),
        standard.postures,
    ),
    Entry(
        "task",
        "What the robot is for: slow combined motion with contact, kept for checking",
        (),
        standard.task,
        standard.task_loads,
    ),
)
_JUMPS = Entry("steps", "Set-points that jump, for plants only", (), standard.jumps, smooth=False)


def catalogue() -> dict[str, Entry]:
    """Return the standard excitations by name."""
    return {entry.name: entry for entry in _ENTRIES}


def excite(
    label: str, robot: Robot, *, posture: str = "p0", duration: float = 4.6, set_point_jumps: bool = False
) -> Excitation:
    """Build a standard excitation.

    Args:
        label: name in the catalogue, with the amplitude as suffix where it is not 1: `reversals`, `sweep_0.8`.
        robot: whose limits and units it is made for.
        posture: where it starts, a key of `POSTURES`.
        duration: length [s].
        set_point_jumps: make `steps` of set-points that jump, as recorded from hosts without a trajectory generator.

    Raises:
        ExcitationError: unknown name or posture, amplitude or duration out of range, or limits not kept.
    """
    match = re.fullmatch(r"([a-z]+)(?:_(\d+(?:\.\d+)?))?", label)
    entry = catalogue().get(match.group(1)) if match else None
    if match is None or entry is None:
        known = ", ".join(catalogue())
        raise ExcitationError("no such excitation", excitation=label, limit=known, remedy="use name or name_amplitude")
    if posture not in POSTURES:
        raise ExcitationError.unknown("no such posture", posture, POSTURES, excitation=label)
    amplitude = float(match.group(2) or 1.0)
    if not 0.05 <= amplitude <= 1.5:
        raise ExcitationError(
            "amplitude out of range",
            excitation=label,
            value=amplitude,
            limit="0.05 to 1.5",
            remedy="write another amplitude behind the name, as in sweep_0.8",
        )
    if not 2.0 <= duration <= 120.0:
        raise ExcitationError(
            "duration out of range [s]",
            excitation=label,
            value=duration,
            limit="2 to 120",
            remedy="choose another duration",
        )
    if set_point_jumps and entry.name == "steps":
        entry = _JUMPS
    time = np.arange(round(duration / robot.control_period)) * robot.control_period
    position, velocity = entry.motion(robot, time, amplitude)
    loads = entry.loads(time, amplitude)
    start = np.asarray(POSTURES[posture])
    made = Excitation(entry.name, amplitude, posture, robot.control_period, start + position, velocity, loads)
    return check_limits(made, robot, jumps=not entry.smooth)
