"""The four statuses and their fields, from findings of the toy machine."""

import pytest
from sher3_diagnosis.finding import ExactFinding
from sher3_diagnosis.flow import diagnose
from sher3_diagnosis.judge.experiments.next_experiment import next_experiment
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Residual, Where
from toy import DIRECTION, Column, Toy, ToyRun, case


class Late(Toy):
    """A toy whose transport is late; what its cause reproduces is given."""

    reproduced = 1.0

    def exact(self, runs, evidence, without):
        where = Where(stage="transport", actuator="all", gap=1e-3, floor=1e-9, unit="m/s", regime="", confidence=1.0)
        closure = Interval(value=self.reproduced)
        delay = Cause(
            effect="command_delay",
            family="timing",
            stage="transport",
            actuator="all",
            parameters={"delay": Parameter(value=1e-3, unit="s")},
            closure=closure,
        )
        return [ExactFinding(where, [delay], closure, Residual(gap=1e-9, floor=1e-9, unit="m/s"))]


def test_a_healthy_machine_has_no_gap():
    verdict = diagnose(Toy(), case(0.0)).verdict
    assert verdict.status == "no_gap"
    assert verdict.where == verdict.causes == []


def test_a_known_effect_is_attributed_with_its_size_and_closure():
    verdict = diagnose(Toy(), case(5.0)).verdict
    assert verdict.status == "attributed"
    assert [c.effect for c in verdict.causes] == ["direction"]
    size = verdict.causes[0].parameters["size"]
    assert size.value == pytest.approx(5.0, abs=0.2)
    assert size.low < 5.0 < size.high
    assert verdict.closure.stage.value > 0.98
    assert verdict.residual.gap == pytest.approx(1.0, abs=0.1)
    assert verdict.where[0].unit == "N" and verdict.where[0].actuator == "axis"


def test_an_effect_left_out_is_outside_the_library():
    verdict = diagnose(Toy(), case(5.0), without=("direction", "speed")).verdict
    assert verdict.status == "outside_library"
    assert verdict.causes == []
    assert verdict.unexplained.stage == "motor_mechanics"
    assert verdict.unexplained.signature.startswith("largest ")


def test_a_rival_of_another_family_is_under_excited_and_proposes_an_experiment():
    twin = Column("twin", "inertia", "direction")
    verdict = diagnose(Toy((DIRECTION, twin)), case(5.0)).verdict
    assert verdict.status == "under_excited"
    assert set(verdict.next_experiment.separates) == {"direction", "twin"}
    assert verdict.next_experiment.expected_odds is None


def test_of_several_open_parts_the_first_alone_is_rehearsed(monkeypatch):
    class Twice(Toy):
        def gather(self, runs):
            return [*super().gather(runs), *super().gather(runs)]

    asked = []

    def counted(machine, finding):
        asked.append(finding)
        return next_experiment(machine, finding)

    monkeypatch.setattr("sher3_diagnosis.judge.judge.next_experiment", counted)
    twin = Column("twin", "inertia", "direction")
    assert diagnose(Twice((DIRECTION, twin)), case(5.0)).verdict.next_experiment is not None
    assert len(asked) == 1


def test_a_rival_of_the_same_family_leaves_the_cause_attributed():
    twin = Column("twin", "friction", "direction")
    verdict = diagnose(Toy((DIRECTION, twin)), case(5.0)).verdict
    assert verdict.status == "attributed"
    assert verdict.causes[0].rivals == ["twin"] or verdict.causes[0].rivals == ["direction"]


def test_an_exact_stage_comes_first_and_must_be_reproduced():
    verdict = diagnose(Late(), case(5.0)).verdict
    assert [w.stage for w in verdict.where] == ["transport", "motor_mechanics"]
    assert {c.effect for c in verdict.causes} == {"command_delay", "direction"}
    assert verdict.status == "attributed"

    class Odd(Late):
        reproduced = 0.5

    odd = diagnose(Odd(), case(0.0)).verdict
    assert odd.status == "outside_library"
    assert "not reproduced" in odd.unexplained.signature


def test_a_companion_comes_after_its_leader_though_it_closes_more():
    leader = Column("stretch", "lost_motion", "position", companion="friction")
    both = [(r, r.values + 16.0 * r.position) for r in case(20.0)]
    runs = [ToyRun(r.excitation, values, r.position, r.velocity) for r, values in both]
    found = diagnose(Toy((DIRECTION, leader)), runs).verdict
    assert [c.effect for c in found.causes] == ["stretch", "direction"]
    alone = Column("stretch", "lost_motion", "position")
    assert diagnose(Toy((DIRECTION, alone)), runs).verdict.causes[0].effect == "direction"
