"""The position run again: what a cause takes off its error, and the constants of a free axis."""

import numpy as np
import pytest
from sher3_chain.axes.causes.refine import refine_free, scaled
from sher3_chain.axes.evidence import gather_axis
from sher3_chain.axes.replay import replay
from sher3_chain.axes.simulate import Law, simulate
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis.verdict import Cause, Interval, Parameter
from slides import axis_of, columns

FALLING = {"signals": columns("position"), "command_law": {"kind": "none"}, "encoder_resolution": 1e-6}


def friction(value, low=None, high=None, effect="coulomb_friction"):
    force = Parameter(value=value, low=low, high=high, unit="N")
    closure = Interval(value=0.9)
    return Cause(
        effect=effect,
        family="friction",
        stage="motor_mechanics",
        actuator="slide",
        parameters={"force": force},
        closure=closure,
    )


def fallen(mass, law, **changes):
    """A record of an axis of 2 kg under 6 N that is let go and rubs."""
    axis = axis_of(**FALLING, gravity={"constant": 6.0}, mass=mass, **changes)
    start = AxesRun("run", 0.002, {"slide": {"position": np.zeros(800)}})
    return gather_axis([AxesRun("run", 0.002, {"slide": {"position": simulate(start, axis, 2.0, law)}})], axis, False)


def test_the_cause_closes_the_error_of_the_position():
    evidence = fallen(2.0, Law(coulomb=1.0, static=1.0))
    found = replay(evidence, [friction(1.0)])
    assert found.after < 0.01 * found.before
    assert found.closure.value == pytest.approx(1.0, abs=1e-3)
    assert "free motion run again from its release" in found.note and "m rms nominal" in found.note


def test_nothing_is_run_again_without_mass_loop_or_a_cause_it_takes_in():
    evidence = fallen(2.0, Law(coulomb=1.0, static=1.0))
    assert replay(evidence, [friction(1.0, effect="backlash")]) is None
    assert replay(evidence, []) is None
    servo = axis_of(signals=columns("position", "reference"), command_law={"kind": "position"})
    still = AxesRun("run", 0.02, {"slide": {"position": np.zeros(400), "reference": np.zeros(400)}})
    assert replay(gather_axis([still], servo, False), [friction(1.0)]) is None


def test_a_free_axis_is_refined_on_its_motion():
    """The force balance gave 10 % too much; the simulated motion fits at the true 1 N."""
    evidence = fallen(2.0, Law(coulomb=1.0, static=1.0))
    same, (refined,) = refine_free(evidence, [friction(1.1, 0.9, 1.3)])
    found = refined.parameters["force"]
    assert found.value == pytest.approx(1.0, rel=0.02) and same.mass == 2.0
    assert found.high - found.value == pytest.approx(0.2 + 1.1 - found.value, rel=1e-6)


def test_a_driven_axis_is_left_as_it_is():
    axis = axis_of()
    run = AxesRun("run", 0.002, {"slide": {n: 1e-3 * np.arange(800.0) for n in ("position", "reference", "command")}})
    evidence, causes = gather_axis([run], axis, False), [friction(1.0)]
    assert refine_free(evidence, causes) == (evidence, causes)


def test_intervals_move_along_and_widen_by_the_change():
    """3 (2 .. 4) times 1.5 is 4.5, half its width 1 + 1.5."""
    p = scaled(friction(3.0, 2.0, 4.0), {"force": 1.5}).parameters["force"]
    assert (p.value, p.low, p.high) == (4.5, 2.0, 7.0)
    assert scaled(friction(3.0), {"force": 1.5}).parameters["force"].low is None
