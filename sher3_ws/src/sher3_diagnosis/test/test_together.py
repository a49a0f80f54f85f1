"""Plain laws fitted at once, beside richer ones, and what laws are allowed to be off by."""

import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.together import law_error, together
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.thresholds import OF_THE_REST, PARSIMONY
from toy import DIRECTION, Column, case, evidence_of


def test_laws_are_off_by_a_share_of_what_they_explain_plain_ones_by_less_than_they_leave_above_the_floor():
    evidence = evidence_of(case(6.0))
    found = fit(evidence.data, [make_term(evidence.data, DIRECTION, "axis", {})])
    share = PARSIMONY * (evidence.null().total - found.total)
    over = found.total - sum(evidence.data.samples.values())
    assert law_error(evidence, found, plain=False) == pytest.approx(share)
    assert law_error(evidence, found, plain=True) == pytest.approx(min(share, OF_THE_REST * max(0.0, over)))


def test_a_plain_law_that_a_richer_one_contains_is_not_fitted_beside_it():
    rich = Column("rich", "friction", "direction", extends=("direction",))
    evidence = evidence_of(case(6.0))
    found = together(
        Candidates(evidence, [DIRECTION, rich]),
        evidence.channels,
        lambda _: {},
        [make_term(evidence.data, rich, "axis", {})],
    )
    assert [t.effect.id for t in found.terms] == ["rich"]
