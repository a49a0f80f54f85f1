"""The grammar of foreign laws: what a sentence says is what is added, and it says nothing the library has."""

import numpy as np
import pytest
from sher3_challenge.plants.grammar import (
    BOUNDED,
    CATALOGUE,
    DIRECTION,
    EFFORT,
    FORCE,
    MAGNITUDE,
    NOTHING,
    ON_FORCE,
    ON_TIP,
    SPEED,
    SQUARE,
    Foreign,
    added,
    along,
)
from sher3_challenge.plants.registry import truth_plants

Q, V, F = np.zeros((4, 5)), np.zeros((4, 5)), np.zeros((4, 5))
V[:, 1] = [2.0, -2.0, 4.0, 0.0]
V[:, 0] = [1.0, 1.0, -1.0, 0.0]
F[:, 0] = [3.0, 3.0, 6.0, 6.0]


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (Foreign(ON_FORCE, 0, 0.5, SPEED, 1, 2.0), [0.5, -0.5, 1.0, 0.0]),
        (Foreign(ON_FORCE, 0, 0.5, SPEED, 1, 2.0, shape=MAGNITUDE), [0.5, 0.5, 1.0, 0.0]),
        (Foreign(ON_FORCE, 0, 0.5, SPEED, 1, 2.0, shape=SQUARE), [0.5, 0.5, 2.0, 0.0]),
        (Foreign(ON_FORCE, 0, 1.0, SPEED, 1, 4.0, shape=BOUNDED), np.tanh([1.0, -1.0, 2.0, 0.0])),
        (Foreign(ON_FORCE, 0, 1.0, SPEED, 1, 2.0, carrier=DIRECTION, slides=1e-3), [1.0, -1.0, -2.0, 0.0]),
        (Foreign(ON_FORCE, 0, 1.0, SPEED, 1, 2.0, carrier=EFFORT, effort=3.0), [1.0, -1.0, 4.0, 0.0]),
        (Foreign(ON_FORCE, 0, 1.0, FORCE, 0, 3.0, time=0.02), [0.5, 0.75, 1.375, 1.6875]),
    ],
)
def test_a_law_adds_what_its_sentence_says(law, expected):
    np.testing.assert_allclose(along(law, Q, V, F, 0.01), expected, atol=1e-12)


def test_a_law_is_added_where_it_acts_and_nowhere_else():
    signal = np.zeros((4, 3))
    assert added(NOTHING, ON_TIP, signal, Q, F, 0.01) is signal
    out = added(Foreign(ON_TIP, 2, 1.0, FORCE, 0, 3.0), ON_TIP, signal, Q, F, 0.01)
    np.testing.assert_allclose(out, np.outer([1, 1, 2, 2], [0, 0, 1]))


def test_thirty_kinds_of_foreign_laws_are_drawn_and_every_plant_has_them_beside_its_own():
    assert len(CATALOGUE) >= 30 and all(kind.effect == "outside_library" for kind in CATALOGUE.values())
    for truth in truth_plants(print):
        assert set(CATALOGUE) < set(truth.outside) and len(truth.outside) >= len(CATALOGUE) + 12
