"""What is worse than it was, worked out by hand on written verdicts, and the files of a baseline."""

import pytest
from sher3.gap import InputError
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Verdict, Where
from sher3_public.guard.baseline import Baseline, Entry, Floor, entry_of, floors_of, read_baseline
from sher3_public.guard.worse import worse

AT = {"stage": "motor_mechanics", "regime": "everywhere", "confidence": 1.0, "unit": "N*m"}


def friction(low, value, high, actuator="elbow", effect="coulomb_friction", rivals=(), condition=None):
    size = Parameter(value=value, low=low, high=high, unit="N*m")
    closure = Interval(value=0.9)
    names = {"effect": effect, "family": "friction", "stage": "motor_mechanics", "actuator": actuator}
    return Cause(parameters={"force": size}, closure=closure, rivals=list(rivals), condition=condition, **names)


def said(*causes, floor=0.02):
    where = [Where(actuator=c.actuator, gap=1.0, floor=floor, **AT) for c in causes]
    verdict = Verdict(status="attributed" if causes else "no_gap", where=where, causes=list(causes))
    return Entry(verdict=verdict, floors=floors_of(verdict))


BEFORE = said(friction(1.0, 1.1, 1.2))


@pytest.mark.parametrize(
    ("now", "rules"),
    [
        (BEFORE, []),
        (said(), []),
        (said(friction(1.3, 1.4, 1.5)), []),
        (said(friction(1.45, 1.5, 1.6)), ["growth"]),
        (said(friction(-1.6, -1.5, -1.45)), ["growth"]),
        (said(friction(None, 1.45, None)), ["growth"]),
        (said(friction(1.0, 1.1, 1.2), friction(0.1, 0.2, 0.3, "shoulder")), ["new cause"]),
        (said(friction(1.0, 1.1, 1.2, effect="backlash")), ["new cause"]),
        (said(friction(1.0, 1.1, 1.2, effect="stiction", rivals=["coulomb_friction"])), []),
        (said(friction(1.0, 1.1, 1.2, condition="day 2")), ["new cause"]),
        (said(friction(1.0, 1.1, 1.2), floor=0.025), ["floor"]),
        (said(friction(1.0, 1.1, 1.2), floor=0.0239), []),
    ],
)
def test_only_what_is_worse_is_told(now, rules):
    assert [w.rule for w in worse(BEFORE, now)] == rules


def test_a_place_without_a_cause_is_new_too():
    gone = Where(actuator="wrist", gap=1.0, floor=0.02, **AT)
    verdict = BEFORE.verdict.model_copy(update={"where": [*BEFORE.verdict.where, gone]})
    (found,) = worse(BEFORE, Entry(verdict=verdict))
    assert (found.rule, found.actuator) == ("new place", "wrist") and "1 N·m rms" in found.text


def test_more_or_less_may_be_allowed():
    now = said(friction(1.3, 1.4, 1.5))
    assert [w.rule for w in worse(BEFORE, now, 0.0)] == ["growth"] and worse(BEFORE, now, 0.1) == []
    assert worse(said(friction(0.0, 0.0, 0.0)), said(friction(1.0, 1.0, 1.0))) == []


def test_a_verdict_and_a_baseline_are_read(tmp_path):
    BEFORE.verdict.write(tmp_path / "verdict.json")
    assert read_baseline(tmp_path / "verdict.json").entry("any") == BEFORE
    (tmp_path / "base.json").write_text(Baseline(logs={"a": BEFORE, "b": BEFORE}).to_json())
    assert read_baseline(tmp_path / "base.json").entry("a") == BEFORE
    with pytest.raises(InputError, match="no such log; value c; limit a, b"):
        read_baseline(tmp_path / "base.json").entry("c")


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"schema": "sher3.baseline/1"}', '{"schema": "sher3.verdict/9"}'])
def test_what_is_no_baseline_is_said(text, tmp_path):
    (tmp_path / "b.json").write_text(text)
    with pytest.raises(InputError, match="is no baseline"):
        read_baseline(tmp_path / "b.json")
    with pytest.raises(InputError, match="cannot be read"):
        read_baseline(tmp_path / "nowhere.json")


def test_floors_of_places_without_a_gap_are_kept(answer):
    floors = entry_of(answer.diagnosis).floors
    assert {name.split("/")[1] for name in floors} == {"turn", "shoulder"}
    assert all(isinstance(f, Floor) and f.unit == "N*m" and f.value > 0.0 for f in floors.values())
