"""Gain errors told by computing the host's law again."""

import numpy as np
import pytest
from recorded import ROBOT, run, stroke
from sher3_gap.stages.exact.controller import controller_finding, gain_error
from sher3_gap.stages.exact.law import host_law


def commanded(scale, ticks=300, spoil=0.0):
    """Return a run whose host works with gains scaled by `scale` (5,)."""
    reference, load = stroke(ticks, 1e-4), stroke(ticks, 0.9e-4)
    base = run(ticks, reference=reference, reference_velocity=stroke(ticks, 1e-4, 3.0), load=load)
    command = host_law(base, ROBOT, ROBOT.position_gain * np.asarray(scale)) + spoil * stroke(ticks, 1e-4, 7.0)
    return run(ticks, reference=reference, reference_velocity=base.reference_velocity, load=load, command=command)


def test_a_host_that_keeps_the_law_has_no_gap():
    assert controller_finding([commanded(np.ones(5))], ROBOT) is None
    assert controller_finding([run(10)], ROBOT) is None


def test_the_same_gain_error_on_all_axes_is_one_cause():
    finding = controller_finding([commanded(np.full(5, 1.1))], ROBOT)
    (cause,) = finding.causes
    assert (cause.effect, cause.actuator, cause.stage) == ("controller_gain", "all", "controller")
    assert cause.parameters["relative"].value == pytest.approx(0.1, rel=1e-6)
    assert finding.closure.value == pytest.approx(1.0)


def test_a_gain_error_on_one_axis_sits_there():
    scale = np.ones(5)
    scale[3] = 0.8
    finding = controller_finding([commanded(scale)], ROBOT)
    assert [(c.actuator, round(c.parameters["relative"].value, 6)) for c in finding.causes] == [("roll", -0.2)]
    assert gain_error([commanded(scale)], ROBOT, 3) == pytest.approx(-0.2)


def test_two_different_gain_errors_are_two_causes():
    finding = controller_finding([commanded([1.1, 1.0, 1.3, 1.0, 1.0])], ROBOT)
    assert {c.actuator for c in finding.causes} == {"delta_1", "delta_3"}
    assert finding.where.actuator == "all"


def test_what_no_gain_reproduces_has_no_cause_and_no_closure():
    finding = controller_finding([commanded(np.ones(5), spoil=1.0)], ROBOT)
    assert finding.causes == []
    assert finding.closure.value == 0.0


def test_a_cause_left_out_is_not_named():
    assert controller_finding([commanded(np.full(5, 1.1))], ROBOT, without=("controller_gain",)).causes == []
