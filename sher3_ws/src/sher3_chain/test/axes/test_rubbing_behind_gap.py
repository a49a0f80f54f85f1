"""A brake behind a gap: its own integrator, an elastic contact that slides at a level; and the same without a gap."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

PERIOD, LEVEL, REACH = 0.002, 900.0, 4e-4


def verdict_of(width, stroke, seed=0):
    """A slide is moved to and fro; the brake moves with the flank of its gap, and slides at its level."""
    rng = np.random.default_rng(seed)
    clock = np.arange(0.0, 20.0, PERIOD)
    path = stroke * (np.sin(3.1 * clock) + 0.3 * np.sin(7.3 * clock + 1.0))
    held, force = path[0], np.empty(len(clock))
    for k, x in enumerate(path):
        beyond = x - held
        bent = np.sign(beyond) * max(abs(beyond) - 0.5 * width, 0.0)
        slid = np.clip(bent, -REACH, REACH)
        held += bent - slid
        force[k] = LEVEL * slid / REACH
    signals = {**columns("position"), **columns("effort", unit="N")}
    law = {"signals": signals, "command_law": {"kind": "force"}, "mass": 2.0, "encoder_resolution": 1e-6}
    given = force + 2.0 * np.gradient(np.gradient(path, PERIOD), PERIOD) + 5.0 * rng.normal(size=len(clock))
    run = AxesRun("run", PERIOD, {"slide": {"position": 1e-6 * np.round(path / 1e-6), "effort": given}})
    return diagnose(machine(**law), [run]).verdict


@pytest.mark.parametrize(("width", "stroke"), [(4e-3, 0.02), (1e-3, 0.02), (4e-3, 0.05)])
def test_gap_and_friction_behind_it(width, stroke):
    verdict = verdict_of(width, stroke)
    (cause,) = verdict.causes
    assert cause.effect == "rubbing_behind_gap" and set(cause.rivals) <= {"presliding_friction"}
    assert cause.parameters["width"].value == pytest.approx(width, rel=0.1)
    assert cause.parameters["load_friction"].value == pytest.approx(LEVEL, rel=0.02)


def test_a_friction_without_a_gap_has_none():
    found = {c.effect for c in verdict_of(0.0, 0.02).causes}
    assert "presliding_friction" in found and "rubbing_behind_gap" not in found
