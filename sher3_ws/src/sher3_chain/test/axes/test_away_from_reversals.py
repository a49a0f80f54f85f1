"""What only the reversals of a dry friction show is its shape, and no cause of its own."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

PERIOD, COUNT = 0.002, 2.0 * np.pi / 8192
INERTIA, DRY, VISCOUS = 2e-4, 0.015, 4e-4


def motor(seconds=16.0, fine=10):
    """Angle and torque (n, 2) of a small motor under a PD law: at its reversals one count is 4 ms."""
    t = np.arange(0.0, seconds, PERIOD)
    asked = 3.0 * np.sin(1.26 * t) + np.sin(5.65 * t + 1.0) + 0.2 * np.sin(19.5 * t + 2.0)
    pace, out, h = np.gradient(asked, PERIOD), np.empty((len(t), 2)), PERIOD / fine
    q, v = float(asked[0]), 0.0
    for k, (r, w) in enumerate(zip(asked.tolist(), pace.tolist(), strict=True)):
        torque = (r - q) + 0.03 * (w - v)
        out[k] = q, torque
        for _ in range(fine):
            v += h * (torque - DRY * float(np.tanh(v / 0.02)) - VISCOUS * v) / INERTIA
            q += h * v
    return out


def test_counts_at_a_reversal_are_no_late_effort():
    """Alone, the search took a delay of -3.8 ms beside the friction; away from reversals it is worth nothing."""
    q, torque = motor().T
    effort = torque + 4e-4 * np.random.default_rng(2).normal(size=len(q))
    signals = {**columns("position", unit="rad"), **columns("effort", unit="N*m")}
    run = AxesRun("run", PERIOD, {"slide": {"position": COUNT * np.round(q / COUNT), "effort": effort}})
    arm = machine(
        motion="rotary",
        signals=signals,
        command_law={"kind": "force", "held": True},
        mass="unknown",
        encoder_resolution=COUNT,
    )
    verdict = diagnose(arm, [run]).verdict
    assert {c.effect for c in verdict.causes} <= {"coulomb_friction", "viscous_friction"}
    force = next(c for c in verdict.causes if c.effect == "coulomb_friction").parameters["force"]
    assert force.low < DRY < force.high
    assert force.value == pytest.approx(DRY, rel=0.15)
