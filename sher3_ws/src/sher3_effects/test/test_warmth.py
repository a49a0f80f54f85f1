"""When a recorded temperature tells something."""

from types import SimpleNamespace

import numpy as np
import pytest
from sher3_effects.drift.force_drift import ForceDrift
from sher3_effects.drift.thermal_expansion import TableExpansion, ThermalExpansion
from sher3_effects.drift.warmth import warm, warming


def runs(*warmth):
    return [SimpleNamespace(warmth=np.array(x)) for x in warmth]


@pytest.mark.parametrize("page", [ForceDrift(), TableExpansion(), ThermalExpansion()])
def test_rounding_of_a_constant_reading_is_no_warmth(page):
    assert page.shapes(runs([-3.6e-15, -3.6e-15]), "tip") == []
    assert page.shapes(runs([0.5, 0.5]), "tip") != []


def test_a_constant_temperature_warms_nothing():
    assert warm(runs([0.0, 0.0], [0.5, 0.5]))
    assert not warming(runs([0.0, 0.0], [0.5, 0.5 + 1e-14]))
    assert warming(runs([0.0, 0.3]))
    assert not warm(runs([]))
