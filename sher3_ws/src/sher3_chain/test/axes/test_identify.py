"""An unknown mass from forces worked out by hand."""

import numpy as np
import pytest
from sher3_chain.axes.identification.identify import identify_mass
from sher3_chain.axes.view import AxisView
from sher3_chain.readings.signals import AxisSignals
from sher3_machines import MachineError
from slides import axis_of

CLOCK = 0.002 * np.arange(10000)


def seen(force, position):
    run = AxisSignals("run", "run", 0.002, position[:, None], effort=force[:, None])
    return AxisView(run, axis_of(mass="unknown", encoder_resolution=1e-7), 0.0)


def swing(mass, viscous=0.0, dry=0.0, offset=0.0):
    """Force of a mass on q = 0.05 sin 3t."""
    q, v, a = 0.05 * np.sin(3 * CLOCK), 0.15 * np.cos(3 * CLOCK), -0.45 * np.sin(3 * CLOCK)
    return mass * a + viscous * v + dry * np.sign(v) + offset, q


@pytest.mark.parametrize("more", [{}, {"viscous": 20.0}, {"dry": 3.0, "offset": -1.0}])
def test_the_mass_is_found_beside_whatever_resists(more):
    mass, (low, high) = identify_mass([seen(*swing(7.0, **more))])
    assert mass == pytest.approx(7.0, rel=0.01)
    assert low <= mass <= high


def test_a_controller_about_one_set_point_is_no_spring():
    """Its effort is a falling line of the place: with a spring beside it the force balance needs no mass at all."""
    x, v, rows = 0.0, 0.0, []
    for k in range(4000):
        read = 1e-6 * round(x / 1e-6)
        u = 400.0 * ((0.1 if k > 500 else 0.0) - read)
        rows.append((u, read))
        for _ in range(10):
            v += 2e-4 * (u - 12.0 * v) / 7.0
            x += 2e-4 * v
    view = seen(*np.array(rows).T)
    mass, _ = identify_mass([view])
    assert view.fed_back and mass == pytest.approx(7.0, rel=0.02)
    force, q = swing(7.0, dry=3.0)
    assert not seen(force + 100.0 * q, q).fed_back and not seen(force, q).fed_back


def test_motion_at_constant_speed_tells_no_mass():
    noise = np.random.default_rng(0).normal(size=len(CLOCK))
    with pytest.raises(MachineError, match="does not tell its mass"):
        identify_mass([seen(5.0 + noise, 0.1 * CLOCK)])


def test_a_record_without_a_moving_sample_is_refused_without_a_warning():
    with pytest.raises(MachineError, match="no sample is left in which it moves"):
        identify_mass([seen(np.zeros(len(CLOCK)), np.zeros(len(CLOCK)))])
