"""What effects and engine see of a run of the robot."""

import numpy as np
import pytest
from recorded import PERIOD, ROBOT, run, stroke
from sher3_diagnosis.channel import Channel
from sher3_gap.stages.geometry import Geometry
from sher3_gap.stages.units import unit_of
from sher3_gap.stages.view import SherView


@pytest.fixture(scope="module")
def view():
    temperature = np.full(400, 25.0)
    return SherView(run(400, motor=stroke(), load=stroke(), temperature=temperature), ROBOT, Geometry(ROBOT))


def test_an_actuator_is_a_row_with_its_nominal_constants(view):
    assert [view.row(a) for a in ("delta_1", "roll", "tilt")] == [0, 3, 4]
    roll = ROBOT.actuators[3]
    assert view.axis("roll")[:4] == (roll.mass, roll.viscous, roll.lead, roll.limits.velocity)
    assert view.lead("roll") == roll.lead


def test_the_tip_is_no_axis(view):
    assert view.motion("tip") is None
    motion = view.motion("delta_2")
    assert motion.top == ROBOT.actuators[1].limits.velocity
    assert motion.position == pytest.approx(view.run.smooth[view.run.grid, 1])
    told = view.quantities("tip")
    assert view.inputs("tip").shape == (len(view.run.grid), sum(x.shape[1] for x in told.values()))


def test_the_speed_of_the_robot_is_the_norm_of_the_axes_shares(view):
    top = np.array([a.limits.velocity for a in ROBOT.actuators])
    k = int(np.argmax(np.abs(view.velocity[:, 0])))
    assert view.speed_share[k] == pytest.approx(np.linalg.norm(view.velocity[k] / top))


def test_warmth_is_above_the_reference(view):
    assert view.warmth == pytest.approx(3.0)
    assert view.temperature_known
    cold = SherView(run(400), ROBOT, Geometry(ROBOT))
    assert not cold.temperature_known and not cold.warmth.any()


def test_a_bristle_slides_to_one_side_after_a_few_deflections(view):
    state = view.sliding(0, 1e-6)
    assert np.abs(state).max() <= 1.0
    rising = slice(round(0.02 / PERIOD), round(0.1 / PERIOD))
    assert state[rising].min() > 0.9
    assert view.sliding(0, 1e-6) is state


@pytest.mark.parametrize(
    ("stage", "actuator", "unit"),
    [("drive", "delta_1", "N"), ("drive", "roll", "N*m"), ("transmission", "roll", "rad"), ("mechanism", "tip", "m")],
)
def test_units_turn_with_roll(stage, actuator, unit):
    assert unit_of(Channel(stage, actuator)) == unit
