"""The one flow: what it asks a machine for, and in which order."""

from dataclasses import replace

import pytest
from sher3_diagnosis import diagnose
from sher3_diagnosis.fit.fitting import make_term
from sher3_diagnosis.flow import UnknownEffect
from toy import DIRECTION, OFFSET, SPEED, Toy, case


def test_the_flow_says_what_it_does_and_keeps_the_evidence():
    said = []
    found = diagnose(Toy(), case(5.0)[:2], say=said.append)
    assert said[0] == "computing residuals and floors" and said[-1] == "judging"
    assert found.verdict.notes == ["few runs"]
    assert found.verdict.seconds > 0.0 and "numpy" in found.verdict.versions
    (finding,) = found.findings
    assert finding.left == {} and list(finding.significant) == [finding.gaps[0].channel]


def test_an_unknown_effect_is_refused_with_those_there_are():
    with pytest.raises(UnknownEffect) as refused:
        diagnose(Toy(), case(0.0), without=("gremlins",))
    assert refused.value.value == "gremlins"
    assert "direction, offset, speed" in str(refused.value)


def test_remarks_and_refinements_of_a_machine_reach_the_verdict():
    class Remarking(Toy):
        def remarks(self, finding):
            return [f"{len(finding.causes)} {finding.causes[0].family} cause of {finding.evidence.excitations[0]}"]

        def refine(self, evidence, causes, attribution):
            known = replace(evidence, excitations=["refined", *evidence.excitations[1:]])
            return known, [c.model_copy(update={"family": "better"}) for c in causes]

        def end_to_end(self, findings, causes):
            return causes[0].closure

    verdict = diagnose(Remarking(), case(5.0)).verdict
    assert verdict.notes == ["1 better cause of refined"]
    assert verdict.causes[0].family == "better"
    assert verdict.closure.tip == verdict.causes[0].closure


class Framed(Toy):
    """The toy with a constant in every fit."""

    def gather(self, runs):
        (found,) = super().gather(runs)
        return [replace(found, nuisance=(make_term(found.data, OFFSET, "axis", {}),))]


def test_what_no_cause_is_asked_for_is_no_gap():
    """A constant of five floors is a gap; where every fit carries a constant anyway, nothing is left of it."""
    assert diagnose(Toy(), case(5.0, "one")).verdict.status != "no_gap"
    assert diagnose(Framed(), case(5.0, "one")).verdict.status == "no_gap"


def test_causes_are_found_beside_what_every_fit_carries():
    runs = [replace(run, values=run.values + 20.0) for run in case(5.0)]
    found = diagnose(Framed((DIRECTION, SPEED)), runs)
    (cause,) = found.verdict.causes
    assert cause.effect == "direction"
    assert cause.parameters["size"].value == pytest.approx(5.0, abs=0.2)
    assert [t.effect.id for t in found.findings[0].attribution.fit.terms] == ["offset", "direction"]
