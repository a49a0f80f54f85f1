"""A spring over position and a weight at an arm: rivals over a small travel, told apart over a large one."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

PERIOD, COUNT, INERTIA, STIFF = 0.005, 1e-5, 0.05, 3.0
T = np.arange(0.0, 40.0, PERIOD)
WAVE = 0.75 * np.sin(0.9 * T) + 0.25 * np.sin(2.9 * T + 0.6)
BEND = -0.75 * 0.81 * np.sin(0.9 * T) - 0.25 * 8.41 * np.sin(2.9 * T + 0.6)


def built_up(q, reach):
    """Dahl friction, -1..1, that builds up over a reach, step by step."""
    state, out = 0.0, np.empty_like(q)
    for k, step in enumerate(np.diff(q, prepend=q[0])):
        state = float(np.clip(state + step / reach * (1.0 - state * np.sign(step)), -1.0, 1.0))
        out[k] = state
    return out


def verdict(travel, force, loop=0.0, inertia=INERTIA):
    """Diagnose an axis that turns by a travel, rad, under a force of its position, with a loop of a share of it."""
    q = 0.5 * travel * WAVE + 0.3
    effort = INERTIA * 0.5 * travel * BEND + force(q)
    effort += loop * np.ptp(force(q)) / 2.0 * built_up(q, 0.1 * travel)
    effort += 3e-3 * np.ptp(effort) * np.random.default_rng(5).normal(size=len(T))
    signals = {**columns("position", unit="rad"), **columns("effort", unit="N*m")}
    of_axis = {"motion": "rotary", "signals": signals, "mass": inertia, "command_law": {"kind": "force"}}
    read = {"position": COUNT * np.round(q / COUNT), "effort": effort}
    axis = machine(**of_axis, encoder_resolution=COUNT)
    return diagnose(axis, [AxesRun("run", PERIOD, {"slide": read})]).verdict


def spring(q):
    return STIFF * (q - 0.1)


def weight(q):
    return STIFF * np.sin(q - 0.1)


@pytest.mark.parametrize(
    ("force", "effect", "name"), [(spring, "spring_torque", "stiffness"), (weight, "gravity_load", "arm")]
)
def test_they_are_told_apart_over_two_radians(force, effect, name):
    """With a loop of 15 % beside them, which is friction."""
    found = verdict(2.2, force, loop=0.15)
    cause = next(c for c in found.causes if c.effect == effect)
    assert found.status == "attributed" and not {"spring_torque", "gravity_load"} & set(cause.rivals)
    assert cause.parameters[name].value == pytest.approx(STIFF, rel=0.1)
    assert {c.family for c in found.causes if c is not cause} == {"friction"}


@pytest.mark.parametrize("force", [spring, weight])
def test_over_a_small_travel_they_are_rivals(force):
    cause = verdict(0.6, force).causes[0]
    assert {cause.effect, *cause.rivals} >= {"spring_torque", "gravity_load"}


def test_a_spring_that_hardens():
    """3 N m/rad in the middle of the travel, 3 + 9 q^2 at its ends; the cube is about the middle, 0.3 rad."""
    found = verdict(1.4, lambda q: STIFF * (q - 0.3) + STIFF * (q - 0.3) ** 3, loop=0.15)
    cause = next(c for c in found.causes if c.effect == "spring_torque")
    assert cause.parameters["stiffness"].value == pytest.approx(STIFF, rel=0.1)
    assert cause.parameters["stiffness_at_end"].value == pytest.approx(STIFF + 9.0 * 0.65**2, rel=0.15)
    assert cause.parameters["rest"].value == pytest.approx(0.3, abs=0.05)
    assert "gravity_load" not in {c.effect for c in found.causes}
