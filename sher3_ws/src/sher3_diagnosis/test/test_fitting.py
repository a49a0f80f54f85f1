"""Least squares with an exact leave-one-run-out loss, on three runs of two samples."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.fit.fitting import fit, make_term, solve
from toy import AXIS, DIRECTION, OFFSET, ToyRun, evidence_of


def run(values):
    n = len(values)
    return ToyRun("sweep", np.array(values, dtype=float), np.zeros(n), np.array([1.0, -1.0] * (n // 2)))


RUNS = [run([1.0, 1.0]), run([2.0, 2.0]), run([6.0, 6.0])]


@pytest.fixture
def data():
    return evidence_of(RUNS).data


def test_each_run_is_scored_with_the_mean_of_the_others(data):
    """The offset of all is 3; without run 0 it is 4, without run 1 it is 3.5, without run 2 it is 1.5."""
    found = fit(data, [make_term(data, OFFSET, "axis", {})])
    assert found.coefficients == pytest.approx([3.0], rel=1e-6)
    assert found.loro_coefficients.ravel() == pytest.approx([4.0, 3.5, 1.5], rel=1e-6)
    assert [found.loss[r, AXIS] for r in range(3)] == pytest.approx([18.0, 4.5, 40.5], rel=1e-6)
    assert found.total == pytest.approx(63.0, rel=1e-6)


def test_without_terms_the_loss_is_that_of_the_residual(data):
    found = fit(data, [])
    assert found.total == pytest.approx(2.0 * (1.0 + 4.0 + 36.0))
    assert found.admissible


def test_terms_know_their_coefficients(data):
    terms = [make_term(data, DIRECTION, "axis", {}), make_term(data, OFFSET, "axis", {})]
    found = fit(data, terms)
    assert found.of(0) == pytest.approx([0.0], abs=1e-6)
    assert found.of(1) == pytest.approx([3.0], rel=1e-6)
    assert found.loro_of(1).shape == (3, 1)
    assert not fit(data, terms[:1]).admissible  # a friction of zero is none


def test_causes_that_take_one_another_back_are_told_by_their_size():
    """Samples of +1 and -1 by columns of (1, 1) and (1, 1.05): 41 of the first and -40 of the second."""
    data = evidence_of([run([1.0, -1.0]), run([1.0, -1.0])]).data
    first = make_term(data, OFFSET, "axis", {})
    columns = [{c: x * [[1.0], [1.05]] for c, x in each.items()} for each in first.columns]
    second = replace(first, columns=columns)
    assert fit(data, [first, second]).cancelled == pytest.approx(41.0, rel=0.05)
    assert fit(data, [make_term(data, DIRECTION, "axis", {})]).cancelled == pytest.approx(1.0)
    assert fit(data, []).cancelled == 0.0


def test_collinear_columns_are_solved_and_dead_ones_are_zero():
    x = np.array([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [3.0, 3.0, 0.0]])
    beta = solve(x.T @ x, x.T @ np.array([2.0, 4.0, 6.0]))
    assert beta[2] == 0.0
    assert beta[0] + beta[1] == pytest.approx(2.0, rel=1e-6)
    assert solve(np.zeros((0, 0)), np.zeros(0)).shape == (0,)


def test_a_view_shared_by_blocks_is_evaluated_once():
    class Counting(type(OFFSET)):
        calls = 0

        def signature(self, view, site, shape):
            Counting.calls += 1
            return super().signature(view, site, shape)

    found = evidence_of(RUNS).data
    found.views = [found.views[0]] * 3
    make_term(found, Counting("offset", "inertia", "one"), "axis", {})
    assert Counting.calls == 1
