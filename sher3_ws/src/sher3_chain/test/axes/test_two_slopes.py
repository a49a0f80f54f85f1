"""A gear that is soft under small torques and stiff under large ones: two encoders and a torque sensor."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

PERIOD = 0.002
T = np.arange(0.0, 24.0, PERIOD)
TORQUE = 30.0 * np.sin(0.63 * T) + 12.0 * np.sin(2.3 * T + 1.0)
LINK = 0.5 * np.sin(0.44 * T) + 0.1 * np.sin(1.3 * T + 0.7)


def twist(torque, knee, soft, stiff):
    beyond = np.maximum(np.abs(torque) - knee, 0.0)
    return np.sign(torque) * (np.minimum(np.abs(torque), knee) / soft + beyond / stiff)


def slipping(torque, size, reach):
    """Friction beside the spring, as many small ones that slip at forces up to `reach`."""
    out, limits = np.zeros_like(torque), np.linspace(0.1, 1.0, 10) * reach
    held = np.zeros(len(limits))
    for k in range(1, len(torque)):
        held = np.clip(held + torque[k] - torque[k - 1], -limits, limits)
        out[k] = size * held.sum() / limits.sum()
    return out


def verdict_of(bend, noise=2e-6):
    rng = np.random.default_rng(4)
    turned = [x + noise * rng.normal(size=len(T)) for x in (LINK + bend, LINK)]
    effort = TORQUE + 0.03 * rng.normal(size=len(T))
    signals = {**columns("position", "load", unit="rad"), **columns("effort", unit="N*m")}
    run = AxesRun("run", PERIOD, {"slide": {"position": turned[0], "load": turned[1], "effort": effort}})
    law = {"command_law": {"kind": "force"}, "mass": None, "encoder_resolution": 2e-6}
    return diagnose(machine(motion="rotary", signals=signals, **law), [run]).verdict


def spring_of(verdict):
    return next(c for c in verdict.causes if c.effect == "transmission_compliance")


def test_two_slopes_and_the_knee_between_them():
    """10 and 30 kN m/rad, 15 N m."""
    verdict = verdict_of(twist(TORQUE, 15.0, 1e4, 3e4))
    found = {name: p.value for name, p in spring_of(verdict).parameters.items()}
    assert verdict.status == "attributed" and len(verdict.causes) == 1
    assert found["stiffness"] == pytest.approx(1e4, rel=0.03)
    assert found["stiffness_beyond"] == pytest.approx(3e4, rel=0.06)
    assert found["knee"] == pytest.approx(15.0, rel=0.06)
    assert spring_of(verdict).parameters["stiffness_beyond"].unit == "N*m/rad"


def test_two_slopes_beside_a_loop():
    """Friction in the flexspline adds a loop of 0.2 mrad either way to the twist."""
    verdict = verdict_of(twist(TORQUE, 15.0, 1e4, 3e4) - slipping(TORQUE, 2e-4, 8.0))
    found = {name: p.value for name, p in spring_of(verdict).parameters.items()}
    assert {c.effect for c in verdict.causes} == {"transmission_compliance", "transmission_hysteresis"}
    assert found["stiffness"] == pytest.approx(1e4, rel=0.1) and found["knee"] == pytest.approx(15.0, rel=0.25)
    assert found["stiffness_beyond"] == pytest.approx(3e4, rel=0.15)


def test_a_straight_spring_has_no_knee():
    found = spring_of(verdict_of(TORQUE / 1e4)).parameters
    assert "knee" not in found and found["stiffness"].value == pytest.approx(1e4, rel=0.02)
