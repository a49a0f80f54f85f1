"""Forces in the unit in which they were recorded, where its value in newtons is unknown: amperes, per cent, volts."""

from __future__ import annotations

from sher3_diagnosis.verdict import Cause

RECORDED = "eu"
"""Unit of the effort as recorded: of a force whose gain nobody stated, and whose column has no unit either."""
OWN_UNITS = {"A": "A", "mA": "A", "V": "V", "mV": "V", "%": "%", "count": "count", "1": RECORDED}
"""Unit of an effort that is no force -> the unit in which forces are then given."""

VOLTAGES = ("V", "mV")
DEMANDS = (*VOLTAGES, "%", "1")
"""Units of what a drive is told: a coil, a propeller or a valve turns it into a force. An effort was read: of that, a
share or a number without a unit is a force already, and only a voltage is none."""


def own_unit_note(axis: str, unit: str) -> str:
    """Return what the unit of an axis' forces is, in words."""
    what = "eu, the unit of the recorded effort" if unit == RECORDED else unit
    return f"{axis}: forces are in {what}: no gain of the drive is stated"


def in_own_unit(cause: Cause, unit: str) -> Cause:
    """Return a cause whose forces are in a unit of their own instead of N or N m."""
    changed = {name: p.model_copy(update={"unit": renamed(p.unit, unit)}) for name, p in cause.parameters.items()}
    return cause.model_copy(update={"parameters": changed})


def renamed(unit: str, own: str) -> str:
    """Return the unit of a parameter with forces in `own`: N*m/(rad/s) becomes A/(rad/s), kg*m^2 A/(rad/s^2)."""
    inertia = {"kg": f"{own}/(m/s^2)", "kg*m^2": f"{own}/(rad/s^2)"}
    if unit in inertia:
        return inertia[unit]
    if unit == "N" or unit.startswith("N/"):
        return own + unit[1:]
    if unit.startswith("N*m"):
        return own + unit[3:]
    for compliance in ("/N", "/(N*m)"):
        if unit.endswith(compliance):
            return f"{unit[: -len(compliance)]}/{own}"
    return unit
