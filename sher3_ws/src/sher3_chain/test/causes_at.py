"""Causes as a verdict states them, for tests of words."""

from sher3_diagnosis.verdict import Cause, Interval, Parameter


def caused(effect, family, joint, name, value, unit, rivals=()):
    """A cause with one parameter, known within a tenth."""
    p = Parameter(value=value, low=0.9 * value, high=1.1 * value, unit=unit)
    closure = Interval(value=0.9, low=0.8, high=1.0)
    return Cause(
        effect=effect,
        family=family,
        stage="motor_mechanics",
        actuator=joint,
        parameters={name: p},
        closure=closure,
        rivals=list(rivals),
    )
