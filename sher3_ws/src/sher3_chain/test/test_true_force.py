"""Friction beside a wrong gain is told as it acts, whatever the drive reports."""

from dataclasses import replace

import pytest
from drawn_axes import drawn_axis
from sher3_chain.joint.true_force import in_true_force
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Cause, Interval, Parameter


def caused(effect, **parameters):
    made = {n: Parameter(value=v, low=low, high=high, unit=u) for n, (v, low, high, u) in parameters.items()}
    sure = Interval(value=1.0, low=1.0, high=1.0)
    return Cause(effect=effect, family="f", stage="motor_mechanics", actuator="a", parameters=made, closure=sure)


def test_a_force_is_as_many_times_larger_as_the_drive_gives_more_than_it_reports():
    """A quarter more than reported: 4 N in the balance are 5 N; half widths 0.3 * 1.25 and 0.1 * 4 make 0.55."""
    gain = caused("torque_constant", relative=(0.25, 0.15, 0.35, "1"))
    dry = caused("coulomb_friction", force=(4.0, 3.7, 4.3, "N"), displacement=(1e-5, 1e-6, 1e-4, "m"))
    alone, doubted = in_true_force([dry]), gain.model_copy(update={"rivals": ["payload_mass"]})
    told, same = in_true_force([dry, gain])
    force = told.parameters["force"]
    assert alone == [dry] and same == gain and told.parameters["displacement"] == dry.parameters["displacement"]
    assert force.value == pytest.approx(5.0)
    assert (force.low, force.high) == pytest.approx((5.0 - 0.5483, 5.0 + 0.5483), abs=1e-4)
    either = in_true_force([dry, doubted])[0].parameters["force"]  # with another mass in its place it is as reported
    assert (either.value, either.low, either.high) == (4.0, 3.7, force.high)


def test_friction_stays_when_the_drive_reports_less():
    """One drawn axis, its efforts as recorded and a tenth smaller: gain and friction are the same forces."""
    drawn, found = drawn_axis(2018), []
    for scale in (1.0, 0.9):
        signals = drawn.run.signals["axis"]
        run = replace(drawn.run, signals={"axis": {**signals, "effort": scale * signals["effort"]}})
        causes = {c.effect: c.parameters for c in diagnose(drawn.machine, [run]).verdict.causes}
        found.append(causes["coulomb_friction"]["force"].value)
        gain = causes["torque_constant"]["relative"].value
        assert scale * (1.0 + gain) == pytest.approx(1.0 + drawn.truth["torque_constant"]["relative"], rel=0.02)
    assert found[1] == pytest.approx(found[0], rel=0.01)
    assert found[0] == pytest.approx(drawn.truth["coulomb_friction"]["force"], rel=0.04)
