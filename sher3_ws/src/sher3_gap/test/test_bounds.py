"""What a page of the robot calls admissible is physically possible: what resists never pushes."""

from itertools import product

import numpy as np
import pytest
from sher3_effects import library
from sher3_gap.evidence import gather
from sher3_gap.stages.units import PLACES
from simulated import ROBOT, runs_of, signals

SIZES = (-1e3, -1.0, -1e-3, 1e-3, 1.0, 1e3)
"""Coefficients that are tried, of every sign and size."""
MANY = 4
"""Coefficients of a page up to which all of these are tried together; of more, random ones."""
SIZE = {
    *("displacement", "static", "stribeck_velocity", "width", "stiffness", "compliance", "time_constant", "frequency"),
    *("limit", "amplitude", "clearance", "damping", "wavelength", "sigma", "probability"),
}
"""Parameters that have no sign on any page."""
RESISTS = {(page.id, "force") for page in library().values() if page.family == "friction"} | {("cable_drag", "force")}
"""Pages whose force resists."""
SIGNED = {("structural_vibration", "amplitude"), ("friction_drift", "force")}
"""Of these a sign is physical: a part of a structure may swing against another; the level at the reference temperature
is extrapolated, or friction that grows from nothing, which scatters about it."""


@pytest.fixture(scope="module")
def evidence():
    return gather(signals(runs_of(("reversals", "loads"), repeats=1)), ROBOT)


@pytest.mark.parametrize("page", library().values(), ids=library())
def test_what_has_no_sign_is_never_below_zero(page, evidence):
    for place in page.places:
        site = PLACES[place][0]
        for shape in page.shapes(evidence.views, site)[:40:5] if page.channels(site) else []:
            found = page.signature(evidence.views[0], site, shape).columns.values()
            count = max((x.shape[-1] for x in found), default=0)
            rng = np.random.default_rng(count)
            tried = product(SIZES, repeat=count) if count <= MANY else rng.choice(SIZES, size=(2000, count))
            for c in map(np.array, tried):
                if page.admissible(shape, c):
                    for name, value in page.parameters(shape, c).items():
                        key = page.id, name
                        bounded = (name in SIZE or key in RESISTS) and key not in SIGNED
                        assert not bounded or value >= 0.0 or site == "force_sensor", (*key, value)


def test_friction_that_changes_never_pushes():
    """Neither at the beginning nor at the end of a change, of either sign; one that runs in to nothing may scatter."""
    page = library()["friction_drift"]
    for ends in ({"time_constant": 2.0}, {"time_constant": 0.0, "coldest": -3.0, "warmest": 4.0}):
        assert page.admissible(ends, np.array([1.0, 0.24]))
        assert page.admissible(ends, np.array([1.0, -0.24]))
        assert not page.admissible(ends, np.array([-1.0, -0.3]))
        assert not page.admissible(ends, np.array([1.0, -1.5]))
    assert page.admissible({"time_constant": 2.0}, np.array([1.0, -1.02]))


def test_friction_over_position_is_that_of_a_function_which_is_nowhere_negative():
    """A full wave down to none, narrow crests (1 + cos) ^ 4 and a comb are; a wave three times its mean is not."""
    page, phase = library()["position_friction"], np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False)
    waves = [np.ones_like(phase), np.cos(phase), np.sin(phase), np.cos(2.0 * phase), np.sin(2.0 * phase)]
    for level in (1.0 + np.cos(phase), (1.0 + np.sin(phase)) ** 4, 1.0 * (np.abs(phase - 2.0) < 0.2)):
        found = np.linalg.lstsq(np.column_stack(waves), level, rcond=None)[0]
        assert page.admissible({}, found)
    assert not page.admissible({}, np.array([1.0, 3.0, 0.0, 0.0, 0.0]))
    assert not page.admissible({}, np.array([-1.0, 0.5, 0.0, 0.0, 0.0]))
