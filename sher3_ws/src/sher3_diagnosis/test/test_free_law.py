"""What free laws leave: of a signal that is a function of their inputs, and of one that is not."""

import numpy as np
import pytest
from sher3_diagnosis.judge.evidence.free_law import folds, linear, loss_left, principal, telling

RNG = np.random.default_rng(1)
RUN = np.repeat(np.arange(6), 150)
OWN, FOREIGN = RNG.uniform(-1.0, 1.0, (2, 900, 1))


def test_a_law_of_its_own_inputs_is_found_on_runs_left_out():
    """A step of +-1 in one input: mean square 1, of which trees leave little."""
    law, anything = loss_left([OWN, FOREIGN], np.sign(OWN), RUN)
    assert law < 0.1
    assert anything <= law


def test_what_depends_on_foreign_inputs_alone_is_left_by_its_own():
    law, anything = loss_left([OWN, FOREIGN], np.sign(FOREIGN), RUN)
    assert law > 0.95
    assert anything < 0.1


def test_noise_is_left_by_everything_and_never_grows():
    noise = RNG.normal(size=(900, 1))
    law, anything = loss_left([OWN, FOREIGN], noise, RUN)
    assert 0.95 * np.mean(noise**2) < anything <= law <= np.mean(noise**2)


def test_a_record_alone_is_predicted_from_its_other_pieces():
    """A slow sweep never comes back to where it was: of two thirds at its end, nobody can tell the first third."""
    sweep = np.linspace(-1.0, 1.0, 900)[:, None]
    assert loss_left([sweep], np.sin(9.0 * sweep), np.zeros(900, int))[0] < 0.1
    assert set(folds(RUN)[:150]) == {0} and len(set(folds(np.zeros(900, int))[:150])) == 3


def test_no_inputs_explain_nothing():
    assert loss_left([np.zeros((900, 0))], np.ones((900, 1)), RUN) == [1.0]


def test_a_linear_law_is_exact_but_for_its_ridge():
    """Standardised input x: the ridge of a hundredth shrinks a slope of 2 to 2 / 1.01."""
    x = np.array([[-1.0], [1.0]])
    assert linear(x, np.array([-2.0, 2.0]))(np.array([[1.0]])) == pytest.approx(2.0 / 1.01)


def test_the_inputs_that_tell_most_are_kept():
    noise = RNG.normal(size=(900, 20))
    inputs = np.hstack([noise, OWN])
    assert 20 in telling(inputs, OWN[:, 0] ** 2, kept=3)
    assert len(telling(inputs, OWN[:, 0], kept=3)) == 3


def test_the_directions_with_most_energy_are_looked_at():
    signal = np.zeros((10, 6))
    signal[:, 4] = 3.0
    assert abs(principal(signal)[4, 0]) == pytest.approx(1.0)
    assert principal(np.ones((5, 1))).tolist() == [[1.0]]
