"""Baselines do what their namesakes do, on residuals whose truth is known."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter
from sher3_challenge.baselines.exact import exact_inputs
from sher3_challenge.baselines.inputs import Candidate, Inputs, Stage, Traces
from sher3_challenge.baselines.rules import BASELINES, all_parameters, best_rmse, iid_bic, lag_of, trace_metrics
from sher3_description import load_robot

DRIVE, MOTOR = ("drive", "roll"), ("motor_mechanics", "tilt")


def inputs(strength, seed=0, runs=4, n=200):
    """One stage with a sine of a known strength in white noise of unit variance; a true and an absorbing candidate."""
    rng = np.random.default_rng(seed)
    t = np.arange(n)
    true, absorber = np.sin(t / 7)[:, None], np.sin(t / 7 + 0.9)[:, None]
    noise = [rng.standard_normal((n, 1)) for _ in range(2 * runs)]
    motor = [strength * true + e for e in noise[:runs]]
    drive = [e for e in noise[runs:]]

    def fitted(shape, data):
        c = sum(float((shape * r).sum()) for r in data) / (runs * float((shape * shape).sum()))
        return [r - c * shape for r in data]

    candidates = [
        Candidate("cogging", "periodic", MOTOR, 2, fitted(true, motor)),
        Candidate("viscous_friction", "friction", MOTOR, 1, fitted(absorber, motor)),
        Candidate("drive_lag", "timing", DRIVE, 1, fitted(true, drive)),
    ]
    return Inputs([Stage(MOTOR, 1.0, motor), Stage(DRIVE, 1.0, drive)], candidates)


@pytest.mark.parametrize("baseline", [best_rmse, iid_bic, all_parameters])
def test_a_clear_effect_is_found_with_its_closure(baseline):
    answer = baseline(inputs(2.0))
    assert answer["causes"][0]["effect"] == "cogging"
    assert answer["where"][0] == {"stage": "motor_mechanics", "actuator": "tilt"}
    assert answer["closure"]["stage"]["value"] == pytest.approx(1.0, abs=0.1)


def test_only_bic_can_say_that_there_is_nothing():
    said = {name: BASELINES[name](inputs(0.0))["status"] for name in ("best_rmse", "iid_bic")}
    assert said == {"best_rmse": "attributed", "iid_bic": "no_gap"}


def test_all_parameters_names_absorbers_too():
    """Correlated noise breaks the iid interval: most seeds blame more than the one true effect."""
    blamed = 0
    for seed in range(10):
        data = inputs(2.0, seed)
        white = np.random.default_rng((seed, 1)).standard_normal((4, 200, 1))
        rough = lfilter([1.0], [1, -0.87], white, axis=1)  # correlated over about seven samples
        nominal = [r + w for r, w in zip(data.stages[0].nominal, rough, strict=True)]
        candidates = [
            Candidate(c.effect, c.family, MOTOR, c.size, [f + w for f, w in zip(c.fitted, rough, strict=True)])
            for c in data.candidates[:2]
        ]
        blamed += len(all_parameters(Inputs([Stage(MOTOR, 1.0, nominal)], candidates))["causes"]) > 1
    assert blamed >= 3


def test_no_candidates_is_no_gap():
    empty = Inputs([Stage(MOTOR, 1.0, [np.ones((5, 1))])], [])
    assert best_rmse(empty)["status"] == iid_bic(empty)["status"] == all_parameters(empty)["status"] == "no_gap"
    assert trace_metrics(empty)["status"] == "no_gap"


def test_trace_metrics_see_a_delay_but_not_behind_an_offset():
    t = np.arange(1000) * 0.002
    sim = np.sin(2 * np.pi * t)
    real = np.sin(2 * np.pi * (t - 0.02))
    assert lag_of(sim, real) == 10
    assert abs(lag_of(sim + 5.0, real + 5.0)) < 10  # the mean is kept, so the offset hides the delay
    answer = trace_metrics(Inputs([], [], Traces(("a", "b"), [np.c_[sim, real]], [np.c_[sim, sim]])))
    assert answer["where"][0] == {"stage": "transport", "actuator": "b"}
    assert answer["causes"][0]["effect"] == "command_delay"


def run_with(command, echo):
    return {"servo_jv": SimpleNamespace(velocity=command), "drives/setpoint_jv": SimpleNamespace(velocity=echo)}


@pytest.mark.parametrize(
    ("late", "effect", "place"), [([1, 1, 1, 1, 1], "command_delay", "all"), ([0, 0, 1, 0, 0], "axis_skew", "delta_3")]
)
def test_exact_stages_tell_a_common_delay_from_that_of_one_axis(late, effect, place):
    u = np.random.default_rng(2).standard_normal((300, 5)) * 1e-3
    prompt = np.roll(u, 1, axis=0)
    mixed = 0.7 * prompt + 0.3 * np.roll(u, 2, axis=0)
    echo = np.where(np.array(late, bool), mixed, prompt)
    stages, candidates = exact_inputs([run_with(u, echo)], load_robot())
    answer = best_rmse(Inputs(stages, candidates))
    assert (answer["causes"][0]["effect"], answer["where"][0]["actuator"]) == (effect, place)
    assert answer["closure"]["stage"]["value"] == pytest.approx(1.0, abs=0.02)
