"""Forces that MuJoCo has as those of a motor without inputs: a passive `dcmotor` (from 4.0 on) beside the drive.

It takes no control, so a corrected model is driven as before. Torques are MuJoCo's: with the motion, where a cause is
the force that the drive needs.
"""

from __future__ import annotations

import math
from importlib import import_module
from xml.etree.ElementTree import Element, SubElement, tostring

from sher3_export.changes import Change
from sher3_export.xml_file import numbers, written

PASSIVE = {"input": "none", "resistance": "1"}
"""What makes a dcmotor passive; the resistance is asked for and does nothing without a motor constant."""
AGAINST = math.pi
"""Phase by which a torque of the joint is behind the force that the drive needs for it, rad."""
BRISTLE, LONGEST = 1e-3, 0.02
"""Shortest and longest travel over which friction builds up from rest, m or rad: small beside a motion."""
SPRING, DAMPER = 0.25, 2.0
"""Stiffness of a bristle, in units of inertia over step^2, and its damping, in those of stiffness times step. MuJoCo
steps the bristle before the joint: with a spring a and a damping b in units of inertia the pair is stable for b > a and
2 b < 4 + a, so from a = 0 to 4/3 where b = 2 a."""
COGGING = ("cogging", "cogging_periods", "cogging_phase")
"""Constants of a cogging, in the order of the attribute of that name."""
LUGRE = ("stiffness", "damping", "coulomb", "static", "stribeck")
"""Values of MuJoCo's LuGre friction, in their order."""


def passive(root: Element, joint: str, what: str, fresh: bool) -> Element:
    """Return a joint's passive motor for a purpose, the last of them; a `fresh` one where that is asked for."""
    actuators = root.find("actuator")
    actuators = SubElement(root, "actuator") if actuators is None else actuators
    standing = [x for x in actuators if x.get("name", "").startswith(f"{joint}_{what}") and x.get("input") == "none"]
    if standing and not fresh:
        return standing[-1]
    name = f"{joint}_{what}" + (f"_{len(standing) + 1}" if standing else "")
    return SubElement(actuators, "dcmotor", {"name": name, "joint": joint, **PASSIVE})


def cogging(root: Element, change: Change) -> str:
    """Write amplitude, periods per radian of the joint times 2 pi, or phase; sines of two diagnoses add."""
    motor = passive(root, change.joint, "cogging", fresh=change.constant == COGGING[0])
    values = numbers(motor.get("cogging"), f"0 0 {AGAINST}")
    values[COGGING.index(change.constant)] = change.value + (AGAINST if change.constant == COGGING[2] else 0.0)
    return field_of(motor, "cogging", values)


def weight(root: Element, change: Change) -> str:
    """Write a weight at an arm, or where it hangs down: a cogging of one period a turn, whatever hangs on the joint."""
    motor = passive(root, change.joint, "weight", fresh=change.constant == "arm")
    amplitude, _, phase = numbers(motor.get("cogging"), f"0 1 {AGAINST}")
    amplitude, phase = (change.value, phase) if change.constant == "arm" else (amplitude, AGAINST - change.value)
    return field_of(motor, "cogging", [amplitude, 1.0, phase])


def inertia_at(root: Element, joint: str) -> float:
    """Return what a force at a joint moves where all others are free, kg or kg m^2; 0 where MuJoCo cannot tell."""
    try:
        model = import_module("mujoco").MjModel.from_xml_string(tostring(root, encoding="unicode"))
        return float(1.0 / model.dof_invweight0[model.joint(joint).dofadr[0]])
    except (ImportError, ValueError, KeyError, ZeroDivisionError):  # not installed, or its meshes lie elsewhere
        return 0.0


def at_rest(root: Element, change: Change, sliding: float, step: float, inertia: float) -> str:
    """Write a friction at rest beside that in motion, which the motor takes over; LuGre's law has both.

    Args:
        root: of the model.
        change: the friction at rest.
        sliding: friction in motion of the same cause, N or N m.
        step: of the simulation, s.
        inertia: that a force at the joint moves, kg or kg m^2: a bristle too stiff for it swings up.
    """
    if change.value <= sliding:
        return "it is no larger than the friction in motion"
    stiffness = min(change.value / BRISTLE, SPRING * inertia / step**2)
    if stiffness * LONGEST < change.value:
        needed = math.sqrt(SPRING * inertia * LONGEST / change.value)
        return (
            f"a bristle on {inertia:.3g} kg m^2 (or kg) is stable to {stiffness:.3g} per unit at steps of {step:g} s "
            f"and would bend more than {LONGEST:g}; a timestep of {needed:.2g} s can express it"
        )
    motor = passive(root, change.joint, "friction", fresh=True)
    return field_of(motor, "lugre", [stiffness, DAMPER * step * stiffness, sliding, change.value, 0.0])


def falling(root: Element, change: Change) -> str:
    """Write the speed over which friction falls from that at rest to that in motion."""
    motor = passive(root, change.joint, "friction", fresh=False)
    values = numbers(motor.get("lugre"), "0 0 0 0 0")
    values[LUGRE.index("stribeck")] = change.value
    return field_of(motor, "lugre", values)


def field_of(element: Element, name: str, values: list[float]) -> str:
    """Set an attribute to some numbers; return nothing: it could be written."""
    element.set(name, written(*values))
    return ""
