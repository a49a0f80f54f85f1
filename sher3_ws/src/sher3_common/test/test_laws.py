"""Laws of one quantity, against values worked out by hand."""

import math

import numpy as np
import pytest
from sher3_common.laws import LAWS, MEMORY, law_value, walk


def value(law, x, a=0.0, b=0.0, moved=0.0, period=0.01):
    return law_value(LAWS[law].code, a, b, x, moved, np.zeros(MEMORY), period)


@pytest.mark.parametrize(
    ("law", "x", "shape", "wanted"),
    [
        ("itself", -2.0, (), -2.0),
        ("size", -2.0, (), 2.0),
        ("square", -2.0, (), 4.0),
        ("signed_square", -2.0, (), -4.0),
        ("rising", -2.0, (), 0.0),
        ("falling", -2.0, (), -2.0),
        ("rising_square", 3.0, (), 9.0),
        ("falling_square", -3.0, (), 9.0),
        ("sine", 0.25, (1.0,), 1.0),
        ("cosine", 0.5, (1.0,), -1.0),
        ("bump", 3.0, (1.0, 2.0), math.exp(-1.0)),
        ("beyond", -3.0, (2.0,), -1.0),
        ("beyond", 1.0, (2.0,), 0.0),
        ("fading", 2.0, (2.0,), math.exp(-1.0)),
        ("decaying", 2.0, (4.0,), math.exp(-0.5)),
    ],
)
def test_laws_without_memory(law, x, shape, wanted):
    assert value(law, x, *shape) == pytest.approx(wanted)


def test_sliding_builds_up_and_turns():
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.linspace(1.0, 0.0, 101)])
    z = walk(LAWS["sliding"].code, 0.1, 0.0, x, 0.01)
    assert z[10] == pytest.approx(1.0 - math.exp(-1.0)) and z[100] == pytest.approx(1.0, abs=1e-4)
    assert z[-1] == pytest.approx(-1.0, abs=1e-3) and walk(LAWS["sliding"].code, 0.1, 0.0, np.ones(5), 0.01).max() == 0


def test_play_follows_at_half_its_width():
    x = np.array([0.0, 0.3, 1.0, 0.9, 0.0])
    assert walk(LAWS["play"].code, 0.4, 0.0, x, 0.01) == pytest.approx([0.0, -0.2, -0.2, -0.1, 0.2])


def test_late_trails_a_ramp_by_its_time_constant_and_rate_is_its_slope():
    x = 2.0 * 0.001 * np.arange(3000)
    assert walk(LAWS["late"].code, 0.1, 0.0, x, 0.001)[-1] == pytest.approx(-2.0 * 0.1, rel=0.01)
    assert walk(LAWS["rate"].code, 0.1, 0.0, x, 0.001)[-1] == pytest.approx(2.0)


def test_ringing_swings_at_its_frequency_about_x_and_dies_away():
    """A step of 1 to 2 at 10 Hz, damping 0.1: beyond 2 half a damped period later, by exp(-pi 0.1), then 2 for good."""
    t = 0.001 * np.arange(3000)
    z = walk(LAWS["ringing"].code, 10.0, 0.1, np.where(t > 0.0, 2.0, 1.0), 0.001)
    half = 0.5 / (10.0 * math.sqrt(1.0 - 0.1**2))
    assert z[0] == 1.0 and z[-1] == pytest.approx(2.0)
    assert t[np.argmax(z)] == pytest.approx(half, abs=0.002)
    assert z.max() == pytest.approx(2.0 + math.exp(-math.pi * 0.1 / math.sqrt(1.0 - 0.1**2)), rel=1e-3)


def test_every_law_says_its_shapes_once():
    assert sorted(law.code for law in LAWS.values()) == list(range(len(LAWS)))
    assert all(len(law.shapes) == len(law.shape_units) <= 2 for law in LAWS.values())
