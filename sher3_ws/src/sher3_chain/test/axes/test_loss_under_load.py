"""A seal that rubs the more the higher its pressure, beside a friction that is there without any."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

PERIOD = 0.005


def verdict_of(share, loads, coulomb=5.0):
    """One record for each load, N; the rod is moved slowly to and fro."""
    signals = {**columns("position"), **columns("effort", "applied", unit="N")}
    runs = []
    for k, load in enumerate(loads):
        clock = np.arange(0.0, 20.0, PERIOD)
        path = 0.03 * np.sin(0.9 * clock + k) + 0.008 * np.sin(2.7 * clock)
        pressed = load * (1.0 + 0.02 * np.sin(0.3 * clock))
        rubs = (coulomb + share * pressed) * np.tanh(np.gradient(path, PERIOD) / 2e-4)
        noise = 0.1 * np.random.default_rng(k).normal(size=len(clock))
        given = {"position": 1e-6 * np.round(path / 1e-6), "applied": -pressed, "effort": pressed + rubs + noise}
        runs.append(AxesRun(f"run{k}", PERIOD, {"slide": given}))
    law = {"signals": signals, "command_law": {"kind": "force"}, "mass": 0.1, "encoder_resolution": 1e-6}
    return diagnose(machine(**law), runs).verdict


def test_a_friction_that_follows_a_known_load():
    verdict = verdict_of(0.05, (50.0, 150.0, 250.0, 350.0))
    (cause,) = verdict.causes
    assert verdict.status == "attributed" and cause.effect == "gear_loss"
    assert cause.parameters["share"].value == pytest.approx(0.05, rel=0.05)
    assert cause.parameters["force"].value == pytest.approx(5.0, rel=0.1)


@pytest.mark.parametrize("loads", [(50.0, 350.0), (200.0, 200.0)])
def test_one_that_does_not_is_plain(loads):
    assert [c.effect for c in verdict_of(0.0, loads).causes] == ["coulomb_friction"]
