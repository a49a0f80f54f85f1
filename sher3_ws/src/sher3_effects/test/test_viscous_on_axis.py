"""Viscous friction of an axis with a stated coefficient of its own."""

import numpy as np
import pytest
from sher3_effects.friction.viscous_friction import ViscousOnAxis


@pytest.mark.parametrize(("nominal", "extra", "possible"), [(0.0, 3.0, True), (0.0, -3.0, False), (5.0, -3.0, True)])
def test_all_of_it_together_resists(nominal, extra, possible):
    """5 N/(m/s) stated and 3 less found still resist; less than nothing does not."""
    assert ViscousOnAxis(nominal).admissible({}, np.array([extra])) == possible
