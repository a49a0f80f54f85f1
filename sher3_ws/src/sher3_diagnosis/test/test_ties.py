"""Choices between effects that give the same data."""

import pytest
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.ties import TIE, first_of_least, ranked
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Signature
from toy import AXIS, Column, case, evidence_of


class Scaled(Column):
    """One quantity of the run times a factor: the same data, rounded differently."""

    def signature(self, view, site, shape):
        (x,) = super().signature(view, site, shape).columns.values()
        return Signature({Channel(self.stage, site): self.factor * x})


def test_the_first_of_the_least_is_taken_where_rounding_would_decide():
    assert first_of_least({"a": 2.0, "b": 1.0 + 1e-9, "c": 1.0}) == "b"
    assert first_of_least({"a": 1.0 + 2 * TIE, "b": 1.0}) == "b"


def test_of_those_that_tie_the_simplest_comes_first():
    value = {"plain": 5.0 + 1e-9, "rich": 5.0, "worse": 6.0, "best": 4.0}
    found = ranked(list(value), value.__getitem__, {"plain": 0, "rich": 1, "worse": 0, "best": 3}.__getitem__)
    assert found == ["best", "plain", "rich", "worse"]


@pytest.mark.parametrize("factor", [1.0, 1.0 / 3.0, 3.0, 1e-3, 0.7])
def test_of_effects_that_give_the_same_data_that_with_fewer_inputs_comes_first(factor):
    plain = Column("plain", "friction", "direction", inputs=("direction",))
    rich = Scaled("rich", "drift", "direction", inputs=("direction", "temperature"), factor=factor)
    evidence = evidence_of(case(5.0))
    for effects in ([rich, plain], [plain, rich]):
        names = [f.terms[-1].effect.id for f in Candidates(evidence, effects).search([AXIS])]
        assert names == ["plain", "rich"]
