"""A slide that is driven against its stops: what they push with is no cause, be its range stated or found."""

import math

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from slides import COUNT, KD, KP, MASS, PERIOD, machine, reference, run_of

END, STIFF, BRAKES = 0.04, 4e6, 4e3
"""Where the stops are, m; their stiffness, N/m, and damping, N s/m."""


def thrown(coulomb, seconds=16.0, fine=40):
    """Position, reference and command (n, 3) of a slide whose reference goes 15 mm beyond either stop."""
    n, h = int(seconds / PERIOD), PERIOD / fine
    q, v, last = 0.0, 0.0, 0.0
    rows = np.empty((n, 3))
    for k in range(n):
        read = COUNT * round(q / COUNT)
        asked = float(reference(k * PERIOD))
        u = KP * (asked - read) - KD * (read - last) / PERIOD
        rows[k], last = (read, asked, u), read
        for _ in range(fine):
            deep = max(abs(q) - END, 0.0)
            stop = -math.copysign(STIFF * deep, q) - BRAKES * v * (deep > 0.0)
            v += h * (u + stop - coulomb * float(np.tanh(v / 2e-4))) / MASS
            q += h * v
    return rows


@pytest.mark.parametrize("coulomb", [0.0, 15.0])
@pytest.mark.parametrize("stated", [{}, {"range": [-END, END]}])
def test_friction_is_told_and_no_stop_is_a_cause(coulomb, stated):
    found = diagnose(machine(**stated), [run_of(thrown(coulomb))]).verdict
    assert any("stops found at -0.039" in note for note in found.notes) == (not stated)
    named = {c.effect: c.parameters for c in found.causes if c.stage == "motor_mechanics"}
    assert set(named) == ({"coulomb_friction"} if coulomb else set())
    assert any("slide: lies beyond the range" in note for note in found.notes)
    if coulomb:
        assert named["coulomb_friction"]["force"].value == pytest.approx(coulomb, rel=0.05)
