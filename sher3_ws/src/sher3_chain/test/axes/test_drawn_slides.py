"""The slide of the tutorial, drawn again: its friction is named whatever noise, encoder and rate the record has."""

import numpy as np
import pytest
from sher3_chain.axes.machine import Axes
from sher3_chain.joint.description import AxesDescription
from sher3_chain.joint.record import AxesRun
from sher3_common.compiled import compiled
from sher3_diagnosis import diagnose

FRICTION = 8.0


@compiled
def played(reference, period, friction, count):
    """Rows of position, command: the slide of the tutorial, 20 kg under a position controller that knows its speed."""
    out = np.empty((len(reference), 2))
    position, velocity = 0.0, 0.0
    for k in range(len(reference)):
        current = 4000.0 * (reference[k] - position) - 150.0 * velocity
        out[k, 0], out[k, 1] = count * np.round(position / count), current
        for _ in range(40):
            velocity += (10.0 * current - friction * np.tanh(velocity / 1e-4)) / 20.0 * period / 40
            position += velocity * period / 40
    return out


def drawn(seed):
    """Return the verdict on one drawing of noise, encoder and rate."""
    rng = np.random.default_rng(seed)
    period, count = float(rng.choice([5e-4, 1e-3, 2e-3])), float(rng.choice([1e-7, 5e-7, 1e-6, 2e-6, 5e-6]))
    time = np.arange(0.0, 16.0, period)
    reference = 0.05 * np.sin(2 * np.pi * 0.25 * time) + 0.02 * np.sin(2 * np.pi * 0.7 * time)
    position, command = played(reference, period, FRICTION, count).T
    noise = rng.normal(0.0, rng.uniform(0.005, 0.05), len(time))
    axis = {
        "name": "slide",
        "motion": "linear",
        "signals": {
            "position": {"column": "q", "unit": "m"},
            "reference": {"column": "r", "unit": "m"},
            "command": {"column": "u", "unit": "A"},
            "effort": {"column": "i", "unit": "A", "factor": 10.0},
        },
        "command_law": {"kind": "force", "gain": 10.0, "position_gain": 4000.0, "velocity_gain": 150.0},
        "mass": 20.0,
        "encoder_resolution": count,
    }
    described = AxesDescription.model_validate(
        {"kind": "axes", "name": "a slide", "time": {"column": "t"}, "axes": [axis]}
    )
    signals = {"position": position, "reference": reference, "command": command, "effort": 10.0 * (command + noise)}
    return diagnose(Axes(described), [AxesRun("run", period, {"slide": signals})]).verdict


def right(verdict):
    """Return whether the friction is attributed, alone, with the true force in its interval."""
    if verdict.status != "attributed" or [c.effect for c in verdict.causes] != ["coulomb_friction"]:
        return False
    force = verdict.causes[0].parameters["force"]
    return force.low <= FRICTION <= force.high


@pytest.mark.parametrize("seed", range(6))
def test_the_friction_of_the_tutorial(seed):
    assert right(drawn(seed))


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_two_hundred_slides():
    wrong = [seed for seed in range(200) if not right(drawn(seed))]
    assert len(wrong) <= 4, f"wrong: seeds {wrong}"
