"""The width of a gap beneath the give of its flanks, on an axis written down by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_effects.limit.force_saturation import ForceSaturation
from sher3_effects.lost_motion.plateau import plateau

GAP, GIVE, FRICTION = 4e-6, 2.5e-7, 4.0
"""m, m/N, N."""


def view(seed, give=GIVE, pull=1.0):
    """Return a run of 20 strokes whose load trails behind a gap with flanks that give, under a pull that changes."""
    rng, n = np.random.default_rng(seed), 2000
    angle = np.linspace(0.0, 40.0 * np.pi, n)
    position, velocity = 1e-3 * np.sin(angle), 2e-2 * np.cos(angle)
    outside = pull * rng.uniform(-1.0, 1.0) * np.sin(np.linspace(0.0, rng.uniform(3.0, 9.0), n))
    side = np.sign(velocity)
    lag = -0.5 * GAP * side + give * (outside - FRICTION * side) + 3e-8 * rng.normal(size=n)
    wide = np.zeros((n, 1))
    run = SimpleNamespace(
        load=position[:, None] + lag[:, None], motor=position[:, None], to_grid=lambda x: x,
        inner=np.ones(n, dtype=bool), loaded_ok=np.ones(n, dtype=bool),
    )  # fmt: skip
    return SimpleNamespace(
        run=run, position=position[:, None], velocity=velocity[:, None], acceleration=wide, row=lambda site: 0,
        axis=lambda site: SimpleNamespace(mass=1.0, top=2e-2),
        path=SimpleNamespace(contact_force=outside[:, None], gravity=wide),
    )  # fmt: skip


def test_the_gap_is_told_beneath_the_give_of_its_flanks():
    found = plateau([view(k) for k in range(6)], "axis", 6e-6, FRICTION)
    assert found.lost == pytest.approx(GAP + 2.0 * GIVE * FRICTION, rel=0.02)
    assert found.width == pytest.approx(GAP, rel=0.03) and 0.0 < found.error < 0.05 * GAP


def test_hard_flanks_and_a_pull_that_does_not_change_tell_nothing():
    assert plateau([view(k, give=0.0) for k in range(6)], "axis", GAP, FRICTION) is None
    assert plateau([view(k, pull=0.0) for k in range(6)], "axis", 6e-6, FRICTION) is None


def test_a_run_at_rest_tells_nothing_and_stops_nothing():
    rest = view(7)
    rest.velocity[:] = 0.0
    assert plateau([rest], "axis", 6e-6, FRICTION) is None
    assert plateau([*(view(k) for k in range(6)), rest], "axis", 6e-6, FRICTION).width == pytest.approx(GAP, rel=0.03)


def test_a_load_without_friction_tells_nothing():
    assert plateau([view(k) for k in range(6)], "axis", 6e-6, 0.0) is None


def test_the_limit_of_a_force_is_the_mean_of_what_is_reported_there():
    """100 ticks at 10 N with a noise of 0.2 N, and 100 far below: the mean within two standard errors."""
    force = np.concatenate([10.0 + 0.2 * np.random.default_rng(1).normal(size=100), np.full(100, 3.0)])
    held = SimpleNamespace(run=SimpleNamespace(effort=force[:, None]), row=lambda site: 0)
    found = ForceSaturation().measured([held], "axis", {"limit": 10.3})["limit"]
    assert abs(found.value - 10.0) < 2.0 * found.error < 0.05
