"""Regimes of a run whose motion is written down sample by sample."""

import numpy as np
import pytest
from sher3_diagnosis.localise.regimes import regime, regime_masks, regime_powers
from sher3_diagnosis.thresholds import JUST_AFTER, REGIME_SAMPLES
from toy import AXIS, ToyRun, evidence_of

N = 40
SPEED = np.concatenate([np.full(N, 0.5), np.full(N, -0.1), np.zeros(N)])  # fast forward, slow backward, at rest
POSITION = np.linspace(0.0, 1.0, 3 * N, endpoint=False)


def run(values, **extra):
    return ToyRun("sweep", np.asarray(values, dtype=float), POSITION, SPEED, **extra)


def masks(evidence, actuator="axis"):
    return regime_masks(evidence, 0, actuator)


def test_speed_direction_reversal_and_phase():
    found = masks(evidence_of([run(np.ones(3 * N))]))
    assert {k: int(v.sum()) for k, v in found["speed"].items()} == {"at rest": N, "slow": N, "fast": N}
    assert found["direction"]["forward"][:N].all() and found["direction"]["backward"][N : 2 * N].all()
    after = found["reversal"]["just after a reversal"]
    assert np.flatnonzero(after).tolist() == list(range(N, N + JUST_AFTER))
    assert [int(m.sum()) for m in found["phase"].values()] == [30, 30, 30, 30]
    assert "temperature" not in found


def test_members_of_a_family_do_not_overlap_and_are_all_samples():
    warmth = np.linspace(0.0, 2.0, 3 * N)
    evidence = evidence_of([run(np.ones(3 * N), loaded=SPEED > 0, warmth=warmth)])
    for family in masks(evidence).values():
        assert (sum(mask.astype(int) for mask in family.values()) == 1).all()
    assert int(masks(evidence)["temperature"]["warm"].sum()) == pytest.approx(1.5 * N, abs=1)


def test_a_place_that_is_no_axis_has_the_speed_of_the_whole_machine():
    found = masks(evidence_of([run(np.ones(3 * N))]), "tip")
    assert set(found) == {"speed", "load", "excitation"}
    assert int(found["speed"]["fast"].sum()) == N


def test_the_gap_is_named_where_its_power_stands_out():
    values = np.where(SPEED < 0, 6.0, 0.1)
    evidence = evidence_of([run(values)])
    powers = regime_powers(evidence, AXIS)
    assert powers["backward"] == pytest.approx(36.0)
    assert powers["forward"] == pytest.approx(0.01)
    assert "backward" in regime(evidence, AXIS) and "slow" in regime(evidence, AXIS)


def test_an_even_gap_is_everywhere_and_few_samples_are_not_told():
    assert regime(evidence_of([run(np.full(3 * N, 6.0))]), AXIS) == "everywhere"
    assert "just after a reversal" not in regime_powers(evidence_of([run(np.ones(3 * N))]), AXIS)
    assert JUST_AFTER < REGIME_SAMPLES
