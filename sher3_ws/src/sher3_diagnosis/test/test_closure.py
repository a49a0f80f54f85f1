"""Closure on held-out runs, by hand: (L0 - L1) / (L0 - F)."""

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel, Residual
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.quantify.closure import closure, interval_of, residual_after, zeros_floor
from sher3_diagnosis.thresholds import PIECES
from toy import AXIS, OFFSET, ToyRun, evidence_of


def run(values, excitation="a"):
    n = len(values)
    return ToyRun(excitation, np.array(values, dtype=float), np.zeros(n), np.ones(n))


RUNS = [run([2.0, 4.0]), run([2.0, 4.0])]


def fits():
    evidence = evidence_of(RUNS, floor=0.5)
    return evidence, fit(evidence.data, []), fit(evidence.data, [make_term(evidence.data, OFFSET, "axis", {})])


def test_what_is_left_is_in_units_of_the_machine():
    """The offset of the other run is 3, so -1 and 1 are left of 2 and 4."""
    evidence, null, after = fits()
    assert residual_after(evidence, null, AXIS)[0].ravel() == pytest.approx([2.0, 4.0])
    assert residual_after(evidence, after, AXIS)[0].ravel() == pytest.approx([-1.0, 1.0], abs=1e-5)


def test_closure_is_the_share_of_the_loss_above_the_floor():
    """Over the floor of 0.5: L0 = (16 + 64) / 2 = 40, L1 = 4, F = 1: 36 / 39."""
    evidence, null, after = fits()
    found = closure(evidence, AXIS, null, after)
    assert found.value == pytest.approx(36.0 / 39.0, rel=1e-5)
    assert (found.low, found.high) == (None, None)  # two runs of two samples carry no interval


def test_few_runs_carry_an_interval_by_their_pieces():
    long = [run(np.tile([2.0, 4.0], 2 * PIECES)) for _ in range(2)]
    evidence = evidence_of(long, floor=0.5)
    null, after = (fit(evidence.data, terms) for terms in ([], [make_term(evidence.data, OFFSET, "axis", {})]))
    found = closure(evidence, AXIS, null, after)
    assert found.low is not None and found.low < found.value < found.high


def test_five_alike_runs_carry_an_interval_of_what_the_floor_may_be_off_by():
    found = interval_of(np.array([[40.0, 4.0, 1.0]] * 5))
    assert found.value == pytest.approx(36.0 / 39.0)
    assert found.low == pytest.approx(1.0 - 4.0 / 40.0)
    assert found.high == found.value


def test_what_a_page_leaves_the_causes_own_law_may_close():
    """Below it is bounded by the runs; a fit without a cause closes nothing, and no law of its own may close more."""
    long = [run(np.tile([2.0, 4.0], 2 * PIECES)) for _ in range(2)]
    evidence = evidence_of(long, floor=0.5)
    null, after = (fit(evidence.data, terms) for terms in ([], [make_term(evidence.data, OFFSET, "axis", {})]))
    assert closure(evidence, AXIS, null, after).high == 1.0
    assert closure(evidence, AXIS, null, null).high == 0.0


def test_nothing_closes_a_gap_that_is_not_there_and_a_worse_fit_opens_it():
    assert interval_of(np.array([[0.9, 0.5, 1.0]])).value == 0.0
    assert interval_of(np.array([[2.0, 3.0, 1.0]])).value == -1.0


def test_repeats_of_partly_free_residuals_differ_by_their_zeros_too():
    """Means of 0 and 2 with the same form: half the mean square difference is 2."""
    channel = Channel("transmission", "axis")
    residuals = [{channel: Residual(np.full((4, 1), v), np.ones(4, dtype=bool), 0.96)} for v in (0.0, 2.0)]
    data = Standardised([None] * 2, residuals, [{channel: np.ones(1)}] * 2)
    evidence = Evidence(excitations=["a", "a"], data=data, units={channel: "m"}, places={})
    assert zeros_floor(evidence, channel) == pytest.approx(2.0)
    assert zeros_floor(evidence_of(RUNS), AXIS) == 0.0
