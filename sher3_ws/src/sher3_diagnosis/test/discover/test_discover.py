"""Discovery on a toy: laws that are known, noise alone, and too little to leave out."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.discover.discover import discover, discover_at, folds
from sher3_diagnosis.discover.feature import FormulaError, Quantity
from sher3_diagnosis.flow import diagnose
from sher3_diagnosis.report.found import found_data, found_text
from sher3_diagnosis.report.page import render
from toy import AXIS, DIRECTION, Toy, ToyView, case, evidence_of, stroke


class TellingView(ToyView):
    """A view that tells what was recorded."""

    step = 0.01

    def recorded(self, channel):
        run = self.run
        return {
            "position": Quantity(run.position, "m", "the position", "place"),
            "velocity": Quantity(run.velocity, "m/s", "the velocity", "speed"),
        }

    def at_residuals(self, x):
        return x


def evidence_with(law, size=10.0):
    runs = [stroke(e, seed=10 * i + k) for i, e in enumerate(("sweep", "slow")) for k in range(3)]
    runs = [replace(r, values=r.values + size * law(r.position, r.velocity)) for r in runs]
    found = evidence_of(runs)
    found.data.views[:] = [TellingView(r) for r in runs]
    return found


def test_a_law_is_found_with_its_coefficient_and_unit():
    found = discover_at(evidence_with(lambda x, v: v * np.abs(v)), AXIS)
    assert [str(t.feature) for t in found.terms] == ["signed_square(velocity)"]
    term = found.terms[0]
    assert term.coefficient.value == pytest.approx(10.0, rel=0.03) and term.coefficient.unit == "N/(m/s)^2"
    assert term.coefficient.low < 10.0 < term.coefficient.high and term.again == 3
    assert found.closure.value > 0.95 and found.ceiling.value > 0.8
    assert found.sentences[0].startswith("an extra force on axis in proportion to the square of the velocity")
    assert "per (m/s)^2" in found.sentences[0]


def test_the_phase_and_the_period_of_a_wave_are_found():
    found = discover_at(evidence_with(lambda x, v: np.sin(2 * np.pi * x / 0.31 + 0.4)), AXIS)
    assert {f.law for t in found.terms for f in t.feature.factors} == {"sine", "cosine"}
    assert found.terms[0].feature.shape[0] == pytest.approx(0.31, rel=0.02)
    wave = {t.feature.factors[0].law: t.coefficient.value for t in found.terms}
    assert np.arctan2(wave["cosine"], wave["sine"]) == pytest.approx(0.4, abs=0.05)


def test_nothing_is_claimed_of_noise():
    found = discover_at(evidence_with(lambda x, v: 0.0 * x), AXIS)
    assert not found.claimed and "no formula" in found.note and "none" in found_text(found)
    assert found_data(found)["terms"] == []


def test_too_few_runs_are_not_searched():
    few = evidence_of([stroke(seed=k, size=9.0) for k in range(3)])
    assert "too few" in discover_at(few, AXIS).note


def test_what_the_library_explains_is_left_alone():
    told = diagnose(Toy(), case(9.0))
    assert "every gap has a cause" in discover(told).note
    assert "no gap" in discover(diagnose(Toy(), case(0.0))).note
    with pytest.raises(FormulaError, match="does not tell"):
        discover(told, AXIS)
    assert "every gap has a cause" in render(told, "toy", discover(told))


def test_an_effect_left_out_is_found_again_as_a_formula():
    told = diagnose(Toy(), case(9.0), without=[DIRECTION.id])
    told.findings[0].evidence.data.views[:] = [TellingView(r) for r in case(9.0)]
    found = discover(told, AXIS)
    assert found.terms[0].feature.factors[0].law == "sliding"
    assert found.closure.value > 0.9
    page = render(told, "toy", found)
    assert "A formula for it" in page and "sliding(position" in page


def test_every_fold_holds_repeats_of_the_others():
    parts = folds(["a"] * 3 + ["b"] * 3 + ["c", "d", "e"])
    assert [len(p) for p in parts] == [3, 3, 3] and all({"a", "b"} <= {"aaabbbcde"[r] for r in p} for p in parts)
