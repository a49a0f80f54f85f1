"""The simulated axis against motions worked out by hand."""

import numpy as np
import pytest
from sher3_chain.axes.simulate import Law, law_of, simulate
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis.verdict import Cause, Interval, Parameter
from slides import axis_of, columns

FREE = {"signals": columns("position"), "command_law": {"kind": "none"}}


def cause(effect, **values):
    parameters = {n: Parameter(value=x, unit="N") for n, x in values.items()}
    closure = Interval(value=1.0)
    return Cause(effect=effect, family="f", stage="s", actuator="slide", parameters=parameters, closure=closure)


def held(n=1000, start=0.0, period=0.001):
    return AxesRun("run", period, {"slide": {"position": np.full(n, start), "reference": np.full(n, start)}})


def test_a_free_axis_falls_under_its_weight():
    """A weight of 6 N pulls 2 kg down by 3 m/s^2: 1.5 m in a second."""
    axis = axis_of(**FREE, gravity={"constant": 6.0})
    assert simulate(held(1001), axis, 2.0, Law())[-1] == pytest.approx(-1.5, rel=2e-3)
    assert simulate(held(1001), axis, 2.0, Law(offset=-6.0))[-1] == pytest.approx(0.0, abs=1e-12)
    assert simulate(held(1001), axis, 2.0, Law(relative=1.0))[-1] == pytest.approx(-3.0, rel=2e-3)


def test_friction_is_a_budget_that_never_drives():
    """7 N of friction hold 6 N of weight; 4 N leave 2 N of it, and the axis never moves up."""
    axis = axis_of(**FREE, gravity={"constant": 6.0})
    assert not simulate(held(1001), axis, 2.0, Law(coulomb=7.0, static=7.0)).any()
    moved = simulate(held(1001), axis, 2.0, Law(coulomb=4.0, static=4.0))
    assert moved[-1] == pytest.approx(-0.5, rel=2e-3) and (np.diff(moved) <= 0.0).all()


def test_a_log_that_is_slower_than_its_loop_is_run_again_all_the_same():
    """A damping of 1200 N/(m/s) stops 2 kg in 1.7 ms; the log has a row each 20 ms."""
    law = {"kind": "force", "position_gain": 1e4, "velocity_gain": 1200.0}
    axis, start = axis_of(command_law=law), held(200, period=0.02)
    start.signals["slide"]["reference"][:] = 0.01
    moved = simulate(start, axis, 2.0, Law())
    assert moved[-1] == pytest.approx(0.01, abs=1e-5) and (np.diff(moved) >= -1e-9).all()


def test_a_loop_settles_where_its_stiffness_carries_the_offset():
    """100 N/m against 2 N: 20 mm behind the reference."""
    axis = axis_of(command_law={"kind": "force", "position_gain": 100.0, "velocity_gain": 30.0})
    settled = simulate(held(8000), axis, 1.0, Law(offset=2.0))
    assert settled[-1] == pytest.approx(-0.02, rel=1e-3)


def test_a_loop_at_its_limit_gives_no_more():
    """A limit of 1 N against 2 N: the axis is driven off with 1 N."""
    law = {"kind": "force", "position_gain": 100.0, "velocity_gain": 30.0, "limit": 1.0}
    moved = simulate(held(2001), axis_of(command_law=law), 1.0, Law(offset=2.0))
    late = np.diff(moved[-1000:], 2) / 0.001**2
    assert late.mean() == pytest.approx(-1.0, rel=0.01)


def test_a_simulation_may_begin_late():
    assert len(simulate(held(1000), axis_of(**FREE), 1.0, Law(), first=400)) == 600


def test_constants_come_from_the_causes_it_can_take_in():
    causes = [cause("coulomb_friction", force=3.0), cause("viscous_friction", extra=2.0), cause("backlash", width=1.0)]
    assert law_of(causes) == Law(coulomb=3.0, static=3.0, viscous=2.0)
    stribeck = cause("stribeck_friction", force=3.0, static=4.0, stribeck_velocity=0.1)
    assert law_of([stribeck]) == Law(coulomb=3.0, static=4.0, stribeck=0.1)
    assert law_of([cause("torque_constant", relative=-0.1), cause("gravity_load", relative=0.2)]) == Law(
        scale=0.9, relative=0.2
    )
