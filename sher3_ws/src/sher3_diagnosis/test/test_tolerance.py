"""Deviations within tolerance: taken off up to the tolerance, never bought as a cause, told in the verdict."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from sher3_diagnosis.fit.fitting import fit
from sher3_diagnosis.fit.solving import solve_within
from sher3_diagnosis.fit.tolerance import as_built, tolerance, within
from toy import DIRECTION, OFFSET, Toy, ToyRun, evidence_of, stroke


def toleranced(runs, limit, effect=OFFSET):
    evidence = evidence_of(runs)
    return replace(evidence, nuisance=as_built(evidence.data, [tolerance(evidence.data, effect, "axis", {}, limit)]))


def runs(size, law="one"):
    return [stroke(e, seed=10 * i + k, size=size, law=law) for i, e in enumerate(("sweep", "slow")) for k in range(3)]


class Toleranced(Toy):
    """The toy robot, whose offset may be 3 N."""

    def gather(self, recorded):
        return [toleranced(recorded, {"offset": (3.0, "N")})]


def test_a_coefficient_beyond_its_limit_is_held_at_it():
    """Two coefficients that share a normal matrix: the first wants 4 and may have 1, the second then takes its part."""
    normal, right = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([8.0, 4.0])
    assert solve_within(normal, right, np.array([np.inf, np.inf])) == pytest.approx([4.0, 0.0], abs=1e-6)
    assert solve_within(normal, right, np.array([1.0, np.inf])) == pytest.approx([1.0, 1.5], abs=1e-3)


def test_what_lies_within_tolerance_is_no_gap_and_is_told():
    """An offset of 2 floors alarms; where the drawing allows 3 it does not, and its value is told."""
    assert diagnose(Toy(), runs(2.0)).verdict.status == "attributed"
    verdict = diagnose(Toleranced(), runs(2.0)).verdict
    assert verdict.status == "no_gap"
    (told,) = verdict.within_tolerance
    assert (told.quantity, told.tolerance, told.unit) == ("offset", 3.0, "N")
    assert told.value == pytest.approx(2.0, abs=0.1)


def test_what_lies_beyond_it_is_a_gap_of_that_cause():
    verdict = diagnose(Toleranced(), runs(8.0)).verdict
    assert [c.effect for c in verdict.causes] == ["offset"]
    assert verdict.causes[0].parameters["size"].value == pytest.approx(8.0, rel=0.05)


def test_a_deviation_within_tolerance_buys_no_second_cause():
    both = [replace(a, values=a.values + 2.9) for a in runs(4.0, "direction")]
    assert {c.effect for c in diagnose(Toy(), both).verdict.causes} == {"direction", "offset"}
    assert [c.effect for c in diagnose(Toleranced(), both).verdict.causes] == ["direction"]


def test_deviations_are_the_robots_own_in_a_run_left_out():
    """One run alone shows an offset of 2 floors: a cause would have to predict it, a deviation need not."""
    evidence = toleranced([stroke(seed=1), stroke(seed=2, size=2.0, law="one")], {"offset": (30.0, "N")})
    held = evidence.null().loro_coefficients
    assert held[0] == pytest.approx(held[1])
    free = fit(evidence.data, [tolerance(evidence.data, OFFSET, "axis", {}, {"offset": (3.0, "N")}).term])
    assert abs(free.loro_coefficients[0] - free.loro_coefficients[1])[0] > 1.0


def test_deviations_that_look_alike_are_one_direction_and_neither_is_told():
    """Two offsets of 3 N each: only their sum shows, and each could be the other."""
    evidence = evidence_of(runs(2.0))
    members = [tolerance(evidence.data, OFFSET, "axis", {}, {name: (3.0, "N")}) for name in ("one", "other")]
    (term,) = as_built(evidence.data, members)
    assert term.width == 1
    assert within(evidence.data, fit(evidence.data, [term])) == []


def test_what_the_data_cannot_see_is_left_out():
    still = [ToyRun("a", np.zeros(50), np.zeros(50), np.zeros(50)) for _ in range(2)]
    evidence = evidence_of(still)
    assert as_built(evidence.data, [tolerance(evidence.data, DIRECTION, "axis", {}, {"friction": (3.0, "N")})]) == ()
