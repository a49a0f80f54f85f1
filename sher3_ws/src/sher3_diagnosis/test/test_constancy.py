"""A true effect has one size in every excitation; a stand-in has not. Worked out on two excitations."""

import numpy as np
import pytest
from sher3_diagnosis.attribute.constancy import constancy_of
from sher3_diagnosis.fit.fitting import fit, make_term
from toy import OFFSET, ToyRun, evidence_of


def constancy(first, second, n=100):
    runs = [ToyRun(e, np.full(n, v), np.zeros(n), np.ones(n)) for e, v in (("a", first), ("b", second))]
    evidence = evidence_of(runs)
    return constancy_of(evidence, fit(evidence.data, [make_term(evidence.data, OFFSET, "axis", {})]), 0)


def test_the_same_size_everywhere_is_constant():
    found = constancy(5.0, 5.0)
    assert found.varying == pytest.approx(0.0, abs=1e-3)
    assert found.constant


def test_sizes_of_four_and_six_differ_by_what_two_fits_explain_more():
    """Together 2 * 100 * 5^2 = 5000, apart 100 * (16 + 36) = 5200: 200 more, 4 % of 5000."""
    found = constancy(4.0, 6.0)
    assert found.explained == pytest.approx(5000.0, rel=1e-4)
    assert found.varying == pytest.approx(200.0, rel=1e-2)
    assert found.spread == pytest.approx(0.04, rel=1e-2)
    assert not found.constant


def test_a_small_loss_does_not_count():
    assert constancy(0.4, 0.6).constant
