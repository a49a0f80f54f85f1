"""Plain laws fitted at once, beside richer ones, and what laws are allowed to be off by."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.together import law_error, together
from sher3_diagnosis.effect import Signature
from sher3_diagnosis.fit.fitting import fit, make_term
from sher3_diagnosis.thresholds import OF_THE_REST, PARSIMONY
from toy import AXIS, DIRECTION, Column, case, evidence_of


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


class Scaled(Column):
    """A gain: direction and speed by the same share."""

    def signature(self, view, site, shape):
        column = np.sign(view.run.velocity) + view.run.velocity
        return Signature({AXIS: column[:, None, None]})


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 2, 0)])
def test_of_causes_that_say_the_same_the_one_stays_that_needs_no_other(order):
    gain = Scaled("gain", "scale", "", plain=True)
    parts = [Column(x, "friction", x, plain=True) for x in ("direction", "velocity")]
    runs = [replace(r, values=r.values + 6.0 * (np.sign(r.velocity) + r.velocity)) for r in case(0.0)]
    evidence = evidence_of(runs)
    effects = [(*parts, gain)[k] for k in order]
    found = together(Candidates(evidence, effects), evidence.channels, lambda _: {})
    assert [t.effect.id for t in found.terms] == ["gain"]
