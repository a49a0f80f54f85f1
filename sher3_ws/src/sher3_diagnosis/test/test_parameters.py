"""Parameters with intervals: the jackknife by hand, and the shares that add to it."""

import numpy as np
import pytest
from sher3_diagnosis.fitting import fit, make_term
from sher3_diagnosis.quantify.parameters import parameters
from sher3_diagnosis.thresholds import JACKKNIFE, LAW_UNCERTAINTY, MIN_RUNS
from toy import OFFSET, Column, ToyRun, evidence_of


def found(values, rotary=frozenset(), effect=OFFSET):
    runs = [ToyRun("a", np.full(2, v), np.zeros(2), np.ones(2)) for v in values]
    evidence = evidence_of(runs, rotary=rotary)
    return parameters(evidence, fit(evidence.data, [make_term(evidence.data, effect, "axis", {})]), 0)["size"]


def test_the_interval_is_that_of_the_jackknife_and_of_the_law():
    """Offsets 1..5: mean 3, standard error of the mean sqrt(2.5 / 5)."""
    size = found([1.0, 2.0, 3.0, 4.0, 5.0])
    half = JACKKNIFE * np.sqrt(0.5) + LAW_UNCERTAINTY * 3.0
    assert size.value == pytest.approx(3.0, rel=1e-5)
    assert (size.low, size.high) == (pytest.approx(3.0 - half, rel=1e-4), pytest.approx(3.0 + half, rel=1e-4))
    assert size.unit == "N"


def test_few_runs_carry_no_interval():
    assert found([1.0] * (MIN_RUNS - 1)).low is None


def test_a_choice_has_no_interval():
    assert found([1.0] * MIN_RUNS, effect=Column("member", "scale", "one", discrete=frozenset({"size"}))).low is None


def test_units_turn_with_the_axis():
    assert found([1.0] * 5, rotary=frozenset({"axis"})).unit == "N*m"
