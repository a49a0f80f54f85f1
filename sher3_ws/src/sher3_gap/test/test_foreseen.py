"""Experiments as the nominal robot foresees them, and doubts that only a tracker or warmth settles."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_diagnosis.channel import AT_TIP, Channel
from sher3_diagnosis.effect import INPUTS
from sher3_effects import plants
from sher3_gap import diagnose_runs
from sher3_gap.evidence import gather
from sher3_gap.experiments.foreseen import LOADED, SAME, TRACKED, WARMED, foreseen
from sher3_gap.experiments.rehearsal import rehearse
from simulated import ROBOT, runs_of, signals

SENSOR = Channel("sensing", "force_sensor")


def untracked(runs):
    """Return runs as if nothing had tracked the tip."""
    return [replace(run, tracker_position=None, tracker_rotation=None, tracker_index=None) for run in signals(runs)]


@pytest.fixture(scope="module")
def short_strokes():
    return untracked(runs_of(["reversals_0.15", "steps_0.2"], [plants()["lead_error"]("delta_2", relative=1e-2)]))


def test_known_loads_and_a_tracker_are_foreseen_where_the_case_has_some_and_where_it_has_none():
    tracked = list(foreseen(gather(signals(runs_of(["loads"], repeats=2)), ROBOT), INPUTS))
    assert {x.added for x in tracked} == {"", WARMED}
    assert {"loads", "postures"} <= {x.excitation for x in tracked}
    bare = list(foreseen(gather(untracked(runs_of(["steps"], repeats=2)), ROBOT), INPUTS))
    assert list(dict.fromkeys(x.added for x in bare)) == ["", LOADED, TRACKED, WARMED]
    assert [x.added for x in bare if x.excitation == "loads"] == [LOADED]
    assert {x.added for x in bare if any(c.stage in AT_TIP for run in x.data.target for c in run)} == {TRACKED}


def test_a_robot_is_warmed_only_for_causes_that_feel_it():
    evidence = gather(signals(runs_of(["loads"], repeats=2)), ROBOT)
    cold = [x.excitation for x in foreseen(evidence, INPUTS.keys() - {"temperature"})]
    assert cold == [x.excitation for x in foreseen(evidence, INPUTS) if x.added != WARMED]


def test_a_robot_without_a_cause_is_foreseen_at_its_floor():
    seen = next(foreseen(gather(signals(runs_of(["steps"], repeats=2)), ROBOT), INPUTS))
    loss = sum(seen.data.null_loss.values()) / sum(seen.data.samples.values())
    assert loss < 1.0


def test_each_excitation_is_simulated_once_for_every_way_to_run_it(monkeypatch):
    made = []

    def counted(robot, asked, **how):
        made.append(asked[0][0].name)
        return rehearse(robot, asked, **how)

    monkeypatch.setattr("sher3_gap.experiments.foreseen.rehearse", counted)
    tried = [x.excitation for x in foreseen(gather(untracked(runs_of(["steps"], repeats=2)), ROBOT), INPUTS)]
    assert len(made) == len(set(made)) == len(set(tried) - {SAME}) < len(tried) / 2


def test_a_new_sensor_shows_deviations_as_built_that_no_recorded_run_does():
    evidence = gather(untracked(runs_of(["steps"], repeats=2)), ROBOT)
    tried = next(x for x in foreseen(evidence, INPUTS) if x.added == TRACKED)
    before, after = ({c.stage for t in terms for c in t.channels} for terms in (evidence.nuisance, tried.as_built()))
    assert not before & set(AT_TIP)
    assert after & set(AT_TIP)
    assert all(len(t.columns) == len(evidence.data.views) + len(tried.data.views) for t in tried.as_built())


def test_a_tracker_is_asked_for_where_a_lead_and_an_encoder_scale_give_the_same(short_strokes):
    asked = diagnose_runs(short_strokes, ROBOT).verdict.next_experiment
    assert asked is not None and {"lead_error", "encoder_scale"} <= set(asked.separates)
    assert asked.added == TRACKED
    assert asked.expected_odds > 0.9


def test_the_recorded_runs_once_warmer_come_before_other_runs_once_warmer():
    evidence = gather(signals(runs_of(["steps", "loads"], repeats=2)), ROBOT)
    same = next(x for x in foreseen(evidence, INPUTS) if x.added == WARMED)
    assert (same.excitation, same.elsewhere, len(same.data.views)) == (SAME, False, 2)
    for r, view in enumerate(same.data.views):
        assert np.abs(view.warmth - 5.0).max() < 0.5  # recorded at the reference
        assert same.data.samples[r, SENSOR] == evidence.data.samples[2 * r, SENSOR]
