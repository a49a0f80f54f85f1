"""Certified silence: bounds by hand, and held on causes drawn anew."""

import numpy as np
import pytest
from sher3_challenge.calibration.selective import CONFIDENCE, GRID, certified, curve, needed


def test_names_without_a_mistake_are_certified_once_they_are_many_enough():
    """All right: 0.95^n <= 0.05 / 8 from n = 99 on (99 * 0.0513 = 5.08 = ln 160.3)."""
    assert (1.0 - CONFIDENCE) / len(GRID) == pytest.approx(1 / 160)
    assert certified([(0.97, True)] * 98, 0.05).threshold is None
    found = certified([(0.97, True)] * 99, 0.05)
    assert (found.threshold, found.named, found.wrong, found.answered) == (0.5, 99, 0, 1.0)


def test_the_doubtful_ones_are_kept_silent():
    """200 sure ones right, 100 at 0.6 of which half are wrong: named from 0.7 on, two causes in three."""
    found = certified([(0.97, True)] * 200 + [(0.6, k % 2 == 0) for k in range(100)], 0.05)
    assert found.threshold == 0.7
    assert found.answered == pytest.approx(2 / 3)


def test_the_table_has_a_line_for_each_risk():
    text = curve([(0.97, True)] * 99 + [(0.55, False)])
    assert "| 0.01 | no odds certified: 505 right names in a row would | 0.00 (n 100) | 0 |" in text
    assert "| 0.05 | 0.6 | 0.99 (n 100) | 0 |" in text
    assert curve([]).count("no odds certified") == 3


def test_what_is_not_certified_says_how_many_names_it_takes():
    """ln 160 / -ln(1 - risk) without a mistake; more with one."""
    assert [needed(risk) for risk in (0.01, 0.05, 0.1)] == [505, 99, 49]
    assert certified([(0.97, k > 0) for k in range(needed(0.05, wrong=1))], 0.05).threshold is not None
    assert certified([(0.97, k > 0) for k in range(needed(0.05, wrong=1) - 1)], 0.05).threshold is None


def test_the_bound_holds_on_causes_drawn_anew():
    """Odds that promise too much: stated p, met p^2. Of 200 sets of causes at most 5 % certify a wrong threshold."""
    rng, broken = np.random.default_rng(0), 0
    for _ in range(200):
        p = rng.uniform(0.5, 1.0, 300)
        found = certified(list(zip(p.tolist(), (rng.random(300) < p**2).tolist(), strict=True)), 0.1)
        if found.threshold is not None:
            x = np.linspace(found.threshold, 1.0, 1001)
            broken += float(np.mean(1.0 - x**2)) > 0.1
    assert broken <= 10
