"""Friction of an axis under a sweep that its log hardly resolves: four to twelve rows for each period at the end."""

import numpy as np
import pytest
from drawn_axes import axis_with, force_at, machine_of
from sher3_chain.joint.record import AxesRun
from sher3_common.compiled import compiled
from sher3_diagnosis import diagnose

STEP = 2e-4
"""Step of the integration, s."""


@compiled
def driven(force, law, band):
    """Return the positions (n,) of an axis under a force (n,), by steps of Heun."""
    out, q, v = np.empty(len(force)), 0.0, 0.0
    for k in range(len(force)):
        out[k] = q
        a = force_at(q, v, force[k], law, band) / law[0]
        b = force_at(q + STEP * v, v + STEP * a, force[k], law, band) / law[0]
        q, v = q + STEP * v, v + 0.5 * STEP * (a + b)
    return out


def swept(seed, rate, dry, viscous):
    """Return the causes named of a sweep up to 0.08 to 0.25 of the rate, Hz; shares of the drive and of the mass."""
    rng = np.random.default_rng([seed, rate])
    every = round(1.0 / rate / STEP)
    clock = np.arange(0.0, rng.uniform(15.0, 30.0), STEP)
    top, mass = rng.uniform(0.08, 0.25) * rate, 10 ** rng.uniform(-2.0, 0.0)
    force = np.sin(2.0 * np.pi * (0.05 + 0.5 * top / clock[-1] * clock) * clock)
    place = driven(force, (mass, dry, viscous * mass, 0.0, 0.0, 0.0, 0.0, 1.0), 1e-3)
    count = float(np.ptp(place)) * 10 ** rng.uniform(-4.5, -3.0)
    rows = force[::every] + rng.normal(0.0, 0.007, len(force[::every]))
    axis = {**axis_with(True, count, ("position", "effort")), "command_law": {"kind": "force"}, "mass": "unknown"}
    signals = {"position": count * np.round(place[::every] / count), "effort": rows}
    return {
        c.effect for c in diagnose(machine_of(axis), [AxesRun("run", every * STEP, {"axis": signals})]).verdict.causes
    }


@pytest.mark.parametrize("rate", [20, 50, 100])
def test_dry_friction_shows_in_a_sweep_whose_turns_no_line_foresees(rate):
    """Its step at every turn was taken for what nobody can foresee, and half of 60 such axes "could not be judged"."""
    found = [swept(seed, rate, dry=0.35, viscous=0.0) for seed in range(3)]
    assert all("viscous_friction" not in f for f in found)
    assert sum("coulomb_friction" in f for f in found) >= 2


def test_a_sweep_without_dry_friction_tells_none():
    assert [swept(seed, 50, dry=0.0, viscous=1.5) for seed in range(3)] == [{"viscous_friction"}] * 3
