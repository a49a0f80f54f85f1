"""What a bent law leaves goes with what it adds; what it does not explain is there where it adds nothing, too."""

import numpy as np
import pytest
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.judge.evidence.bent import added, stray_share
from sher3_diagnosis.judge.evidence.cause import cause_evidence
from sher3_diagnosis.judge.evidence.scales import scaled_cause, strange
from sher3_diagnosis.quantify.closure import residual_after
from toy import AXIS, SPEED, ToyRun, evidence_of

RNG = np.random.default_rng(7)
NOISE = RNG.normal(size=(3000, 1))
OWN = 10.0 * np.sin(np.linspace(0.0, 60.0, 3000))[:, None]
WAVE = np.sin(np.linspace(0.0, 517.0, 3000))[:, None]


def test_a_remainder_in_proportion_to_its_law_is_no_stray():
    """A bend of a third: (10 / 3)^2 / 4 = 2.8 of power over the floor."""
    assert stray_share(NOISE + WAVE * OWN / 3.0, OWN) < 0.1


def test_a_remainder_that_does_not_know_its_law_is_all_stray():
    assert stray_share(NOISE + 2.4 * WAVE, OWN) > 0.9


def test_half_of_each_is_half():
    assert stray_share(NOISE + WAVE * OWN / 3.0 + 2.35 * np.roll(WAVE, 40), OWN) == pytest.approx(0.5, abs=0.15)


def test_a_component_on_which_the_law_does_nothing_is_all_stray():
    left = np.hstack([NOISE + WAVE * OWN / 3.0, NOISE + 10.0 * WAVE])
    assert stray_share(left, np.hstack([OWN, 0.0 * OWN])) > 0.9
    assert stray_share(NOISE + 10.0 * WAVE, 0.0 * OWN) == 1.0


def test_a_remainder_at_the_floor_tells_no_bend():
    """Noise a hundredth above its floor: its squares know nothing of the law."""
    assert stray_share(1.005 * NOISE, OWN) == 1.0


def test_a_bend_counts_the_less_the_smaller_it_is():
    assert strange({"left": 0.11, "stray": 0.01}) == pytest.approx(0.01 + 0.05)  # a bend of a tenth: half of it
    assert strange({"left": 0.02, "stray": 0.0}) == pytest.approx(0.02 / 6.0)
    assert strange({"left": 0.90, "stray": 0.0}) == pytest.approx(0.81)
    assert strange({"left": 0.09}) == 0.09  # evidence of before
    assert strange({"left": -0.05, "stray": -0.02}) == pytest.approx(-0.02)


def runs(bend: float, foreign: float) -> list[ToyRun]:
    """Return runs with a drag of 10 floors per m/s, bent along the travel, and a push that nothing states."""
    out = []
    for k in range(4):
        clock = np.linspace(0.0, 20.0, 800) + k
        position, velocity = np.sin(clock), np.cos(clock)
        force = 10.0 * velocity * (1.0 + bend * np.sin(25.0 * position)) + foreign * np.sin(7.3 * clock)
        noise = np.random.default_rng(k).normal(size=800)
        out.append(ToyRun("sweep", noise + force, position, velocity))
    return out


@pytest.mark.parametrize(("bend", "foreign", "bent"), [(0.4, 0.0, True), (0.0, 2.0, False)])
def test_a_bent_law_and_a_foreign_one_that_leave_as_much_are_told_apart(bend, foreign, bent):
    evidence = evidence_of(runs(bend, foreign))
    found = fit(evidence.data, [make_term(evidence.data, SPEED, "axis", {})])
    numbers = cause_evidence(evidence, Attribution(found, ((),), (1.0,), ((),)), 0).numbers()
    assert 0.02 < numbers["left"] < 0.1
    assert (numbers["stray"] < 0.2 * numbers["left"]) is bent
    plain = {n: x for n, x in numbers.items() if n != "stray"}
    assert (scaled_cause(numbers)["left"] < scaled_cause(plain)["left"] - 0.5) is bent


def test_what_a_term_adds_is_what_the_remainder_lacks():
    evidence = evidence_of(runs(0.0, 0.0))
    found = fit(evidence.data, [make_term(evidence.data, SPEED, "axis", {})])
    left = residual_after(evidence, found, AXIS)
    whole = np.concatenate([r.values[:, None] for r in runs(0.0, 0.0)])
    assert added(found, 0, AXIS, left) == pytest.approx(whole - np.concatenate(list(left.values())))
    assert not added(found, 0, Channel("drive", "axis"), left).any()
