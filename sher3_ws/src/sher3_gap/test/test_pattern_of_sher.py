"""Where a gap lives against where its cause says it does."""

import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.localise.pattern import pattern_of
from sher3_diagnosis.localise.regimes import regime_masks
from sher3_effects import library, plants
from sher3_gap.evidence import gather
from simulated import ROBOT, runs_of, signals

RUBBING = plants()["coulomb_friction"]("tilt", force=1.0)


@pytest.fixture(scope="module")
def evidence():
    return gather(signals(runs_of(("sweep", "reversals", "steps"), [RUBBING], repeats=2, duration=2.5)), ROBOT)


def agreement(evidence, effect):
    fit = Candidates(evidence, list(library().values())).best(library()[effect], "tilt")
    return pattern_of(evidence, fit, 0)


def test_the_gap_of_a_true_cause_lives_where_it_predicts(evidence):
    found = agreement(evidence, "coulomb_friction")
    assert found.agreement > 0.95
    assert set(found.mismatch) >= {"speed", "direction", "reversal", "phase", "excitation"}


@pytest.mark.parametrize("stand_in", ["viscous_friction", "cogging"])
def test_a_stand_in_takes_off_loss_in_other_places(evidence, stand_in):
    found = agreement(evidence, stand_in)
    assert found.agreement < 0.9
    assert found.worst is not None and abs(found.worst.realised - found.worst.predicted) > 0.03


def test_shares_of_a_family_add_up_to_one(evidence):
    shares = [s for s in agreement(evidence, "coulomb_friction").shares if s.family == "speed"]
    assert sum(s.predicted for s in shares) == pytest.approx(1.0)
    assert sum(s.realised for s in shares) == pytest.approx(1.0)


def test_regimes_of_a_family_do_not_overlap(evidence):
    for family in regime_masks(evidence, 0, "tilt").values():
        assert (sum(mask.astype(int) for mask in family.values()) <= 1).all()
