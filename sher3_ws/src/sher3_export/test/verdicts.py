"""Verdicts made by hand for the tests."""

from sher3_diagnosis.verdict import Cause, Interval, Parameter, Verdict, Where


def cause(effect, actuator="slide", rivals=(), unit="N", **parameters):
    fields = {
        name: Parameter(value=x, low=0.9 * x, high=1.1 * x, unit=unit) if not isinstance(x, Parameter) else x
        for name, x in parameters.items()
    }
    return Cause(
        effect=effect,
        family="friction",
        stage="motor_mechanics",
        actuator=actuator,
        parameters=fields,
        closure=Interval(value=0.9),
        rivals=list(rivals),
    )


def verdict(*causes):
    where = Where(
        stage="motor_mechanics", actuator="slide", gap=1.0, floor=0.1, unit="N", regime="everywhere", confidence=1.0
    )
    return Verdict(status="attributed", where=[where], causes=list(causes))
