"""The designed experiment: within limits, readable by player and simulator, and it resolves the ambiguity."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_common import FileError
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.verdict import Verdict
from sher3_effects import plants
from sher3_gap import diagnose_runs
from sher3_gap.excitation import ExcitationError
from sher3_gap.excitation.file import load_excitation, save_excitation
from sher3_gap.experiments.design import ExperimentError, Given, design_experiment, realised
from sher3_gap.experiments.family import CHOICES, Design, build
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.experiments.separation import Prediction, Separation
from simulated import ROBOT, SCATTER, runs_of, signals

TRUTH = plants()["presliding_friction"]("tilt", force=0.5, displacement=12e-6)


@pytest.fixture(scope="module")
def ambiguous():
    return runs_of(["task"], [TRUTH])


def test_the_experiment_resolves_what_the_task_left_open(ambiguous, tmp_path):
    before = diagnose_runs(signals(ambiguous), ROBOT).verdict
    assert {"coulomb_friction", "presliding_friction"} == {before.causes[0].effect, *before.causes[0].rivals}

    designed = design_experiment(before, ROBOT, choices={"dwell": (0.5,), "load": (1.0,)})
    assert designed.predicted.margin > 1.0
    save_excitation(tmp_path / "tell.yaml", designed.excitation)
    again = load_excitation(tmp_path / "tell.yaml", ROBOT)
    more = rehearse(ROBOT, [(again, r) for r in range(3)], [TRUTH], seed=9, scatter=SCATTER)

    found = realised(before, ROBOT, signals(more))
    predicted = designed.predicted
    print(f"predicted {predicted.floors:.2f} ± {predicted.spread:.2f} floors, realised {found.floors:.2f}")
    assert found.margin > 1.0
    assert found.floors == pytest.approx(predicted.floors, abs=max(3.0 * predicted.spread, 0.3 * predicted.floors))

    after = diagnose_runs(signals(more), ROBOT).verdict
    assert after.status == "attributed"
    assert after.causes[0].effect == "presliding_friction"
    assert after.causes[0].actuator == "tilt"
    assert after.causes[0].rivals == []


def test_the_case_says_what_floors_loads_and_excitations_there_are(ambiguous):
    given = Given.of(signals(ambiguous), ROBOT)
    assert given.present == {"task"} and given.loads
    assert given.floor[Channel("motor_mechanics", "tilt")] > 0.0
    free = [replace(run, metadata=replace(run.metadata, payload=())) for run in ambiguous[:2]]
    assert not Given.of(signals(free), ROBOT).loads


def test_a_prediction_is_the_mean_over_draws():
    made = Prediction((Separation(2.0, 3.0, "a"), Separation(4.0, 0.5, "b"), Separation(3.0, 1.5, "a")))
    assert (made.floors, made.spread, made.closest) == (3.0, 1.0, "a")
    assert made.resolved == pytest.approx(2 / 3)


def test_nothing_to_tell_apart():
    with pytest.raises(ExperimentError, match="no rivals"):
        design_experiment(Verdict(status="no_gap"), ROBOT)


@pytest.mark.parametrize("parameter", CHOICES)
def test_every_member_of_the_family_keeps_the_limits(parameter):
    for value in CHOICES[parameter]:
        made = build(Design(**{parameter: value}), ROBOT)
        assert np.ptp(made.position, axis=0).max() > 0.0


def test_a_file_round_trips(tmp_path):
    made = build(Design(load=1.0, posture="p2"), ROBOT)
    again = load_excitation(save_excitation(tmp_path / "e.yaml", made), ROBOT)
    assert (again.position == made.position).all() and (again.velocity == made.velocity).all()
    assert np.allclose(again.loads, made.loads)
    assert (again.name, again.posture) == (made.name, made.posture)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"schema": "sher3.effects/1"}, "not an excitation"),
        ({"period": 0.001}, "control period"),
        ({"data": "../e.npz"}, "plain name"),
        ({"data": "gone.npz"}, "no such file"),
        ({"surprise": 1}, "not an excitation"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, change, words):
    import yaml

    path = save_excitation(tmp_path / "e.yaml", build(Design(), ROBOT))
    header = yaml.safe_load(path.read_text()) | change
    path.write_text(yaml.safe_dump(header))
    with pytest.raises(FileError, match=words):
        load_excitation(path, ROBOT)


def test_set_points_beyond_the_limits_are_refused(tmp_path):
    made = build(Design(), ROBOT)
    path = save_excitation(tmp_path / "e.yaml", made)
    np.savez(tmp_path / "e.npz", position=made.position + 0.05, velocity=made.velocity)
    with pytest.raises(ExcitationError, match="limit"):
        load_excitation(path, ROBOT)
    np.savez(tmp_path / "e.npz", position=made.position * np.nan, velocity=made.velocity)
    with pytest.raises(FileError, match="finite"):
        load_excitation(path, ROBOT)
