"""Discovered formulas in the plant: the same motion as an effect that has the same law, and what is refused."""

import numpy as np
import pytest
from sher3_description import load_robot
from sher3_sim import EffectError
from sher3_sim.closed_loop import excitation, simulate_arrays
from sher3_sim.found import AXIS_TERMS, FoundTerm, add_terms
from sher3_sim.parameters import nominal_parameters

ROBOT = load_robot()
N, AXIS = 600, 1
TIME = ROBOT.control_period * np.arange(N)
PATH = np.repeat((1e-3 * np.sin(2 * np.pi * 2.0 * TIME))[:, None], 5, axis=1)
DRIVE = excitation(PATH, temperature=24.0, period=ROBOT.control_period)


def plant():
    return nominal_parameters(ROBOT).without_noise()


def with_formula(stage, *terms, body=False):
    p = plant()
    holder = p.body if body else p.axis[AXIS : AXIS + 1]
    add_terms(holder["found"][0], stage, terms)
    holder["found_any"] = True
    return simulate_arrays(p, DRIVE)[1]


def test_drag_in_proportion_to_speed_is_viscous_friction():
    found = with_formula("motor_mechanics", FoundTerm(0, 50.0, [("itself", "velocity", ())]))
    p = plant()
    p.axis["viscous"][AXIS] += 50.0
    same, nominal = simulate_arrays(p, DRIVE)[1], simulate_arrays(plant(), DRIVE)[1]
    apart = np.abs(nominal["effort"][:, AXIS] - same["effort"][:, AXIS]).max()
    assert np.abs(found["effort"][:, AXIS] - same["effort"][:, AXIS]).max() < 0.03 * apart


def test_a_shift_in_proportion_to_position_is_a_lead_error():
    found = with_formula("transmission", FoundTerm(0, 1e-3, [("itself", "position", ())]))
    lag = (found["load"] - found["motor"])[:, AXIS]
    assert lag == pytest.approx(1e-3 * found["motor"][:, AXIS], abs=2e-9)


def test_an_extra_effort_is_reported_and_taken_by_the_integrator():
    found, nominal = with_formula("drive", FoundTerm(0, 0.5, [])), simulate_arrays(plant(), DRIVE)[1]
    assert (found["effort"] - nominal["effort"])[-1, AXIS] == pytest.approx(0.0, abs=0.05)  # the motion is the same
    assert np.abs((found["motor"] - nominal["motor"])[:, AXIS]).max() > 1e-6  # but for the jolt at the start


def test_a_drive_that_gives_less_than_its_law_asks_for():
    found = with_formula("drive", FoundTerm(0, -0.2, [("itself", "law", ())]))
    nominal = simulate_arrays(plant(), DRIVE)[1]
    late = np.abs((found["motor"] - nominal["motor"])[:, AXIS]).max()
    assert 1e-7 < late < 1e-4 and np.all(np.isfinite(found["effort"]))  # the integrator makes up for it


def test_growth_at_the_tip_and_a_bias_of_the_sensor():
    nominal = simulate_arrays(plant(), DRIVE)[1]
    tip = with_formula("mechanism", FoundTerm(2, 3e-6, [("itself", "warmth", ())]), body=True)
    assert (tip["tip_position"] - nominal["tip_position"])[:, 2] == pytest.approx(6e-6, abs=1e-12)
    bias = with_formula("sensing", FoundTerm(4, 0.01, [("rising", "touch.x", ())]), FoundTerm(0, 0.2, []), body=True)
    assert (bias["wrench"] - nominal["wrench"])[:, 0] == pytest.approx(0.2, abs=1e-6)


def test_direction_is_told_from_the_path_as_in_the_diagnosis():
    from sher3_common.laws import LAWS, walk

    found = with_formula("transmission", FoundTerm(0, 1e-5, [("sliding", "position", (1e-4,))]))
    z = walk(LAWS["sliding"].code, 1e-4, 0.0, np.ascontiguousarray(found["motor"][:, AXIS]), ROBOT.control_period)
    assert (found["load"] - found["motor"])[:, AXIS] == pytest.approx(1e-5 * z, abs=1e-7)


def test_a_demand_that_comes_a_tick_late():
    """The command of the tick before, in the words of a formula."""
    found = with_formula("transport", FoundTerm(0, -1.0, [("itself", "command.change_1", ())]))
    p = plant()
    p.axis["delay"][AXIS] += ROBOT.control_period
    late = simulate_arrays(p, DRIVE)[1]
    assert found["motor"][:, AXIS] == pytest.approx(late["motor"][:, AXIS], abs=1e-9)
    assert np.abs((late["motor"] - simulate_arrays(plant(), DRIVE)[1]["motor"])[:, AXIS]).max() > 1e-6


def test_a_host_with_another_gain():
    found = with_formula("controller", FoundTerm(0, 5.0, [("itself", "error", ())]))
    p = plant()
    p.axis["position_gain"][AXIS] += 5.0
    assert found["motor"][:, AXIS] == pytest.approx(simulate_arrays(p, DRIVE)[1]["motor"][:, AXIS], abs=1e-9)


def test_a_host_that_works_with_an_earlier_reading():
    """Its law of the reading two ticks ago, told from the commands and readings of the run itself."""
    p = plant()
    add_terms(p.axis["found"][AXIS], "controller", [FoundTerm(0, 20.0, [("itself", "reading.change_2", ())])])
    p.axis["found_any"][AXIS] = True
    commands, found = simulate_arrays(p, DRIVE)
    reading, gain = found["load"][:, AXIS], ROBOT.position_gain
    stale = np.concatenate([reading[:1].repeat(2), reading[:-2]])
    law = DRIVE.velocity[:, AXIS] + gain * (PATH[:, AXIS] - reading)
    top = ROBOT.actuators[AXIS].limits.velocity
    free = (np.abs(law) < top) & (np.abs(commands[:, AXIS]) < top)  # the others are clamped
    assert free.mean() > 0.7
    assert (commands[:, AXIS] - law)[free] == pytest.approx(20.0 * (reading - stale)[free], abs=1e-9)


@pytest.mark.parametrize(
    ("stage", "term", "what"),
    [
        ("thinking", FoundTerm(0, 1.0, []), "at this stage"),
        ("motor_mechanics", FoundTerm(0, 1.0, [("itself", "mood", ())]), "no such quantity"),
        ("sensing", FoundTerm(0, 1.0, [("itself", "velocity", ())]), "no such quantity"),
    ],
)
def test_what_the_plant_cannot_express_is_refused(stage, term, what):
    with pytest.raises(EffectError, match=what):
        add_terms(plant().axis["found"][0], stage, [term])


def test_there_is_an_end_of_terms():
    with pytest.raises(EffectError, match="no more terms"):
        add_terms(plant().axis["found"][0], "drive", [FoundTerm(0, 1.0, [])] * (AXIS_TERMS + 1))
