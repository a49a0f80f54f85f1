"""Folds of postures with the frames free, and records that no answer could rest on."""

import numpy as np
import pytest
from arms import described, machine, measured
from sher3_machines import MachineError
from sher3_static.arm.kind import TIP
from sher3_static.arm.reading import read_arm
from sher3_static.arm.words import fitted_errors, held_out
from sher3_static.thresholds import FOLDS

NOISE = 2e-4


@pytest.fixture(scope="module")
def evidence():
    return machine().gather([measured(np.zeros(6)), measured(np.zeros(6), seed=1)])[0]


def test_every_posture_is_in_one_fold(evidence):
    assert evidence.table.view.rows == 160 and len(evidence.views) == FOLDS
    assert sum(int(r[TIP].ok.sum()) for r in evidence.data.residuals) == 160


def test_the_frames_are_carried_by_every_fit(evidence):
    """Twelve numbers, and six by which the measuring frame of the second run differs."""
    assert [t.width for t in evidence.null().terms] == [18]
    assert evidence.places == {"joint": machine().known.arm.names}


def test_held_out_errors_are_a_little_larger_than_those_fitted(evidence):
    """Eighteen numbers fitted to 160 positions of three noisy entries: 4 % less power where they are fitted."""
    held, fitted = (np.mean(x(evidence, evidence.null()) ** 2) for x in (held_out, fitted_errors))
    assert held > fitted
    assert fitted == pytest.approx(NOISE**2, rel=0.15)


def test_orientations_are_judged_only_where_their_noise_is_stated(evidence):
    assert evidence.floors[0][TIP][3] == 1e3
    assert evidence.unit(TIP) == "m" and evidence.unit(TIP, 3) == "rad"
    assert machine(noise_rotation=1e-3).gather([measured(np.zeros(6))])[0].floors[0][TIP][3] == 1e-3


def tables(**changes):
    record = measured(np.zeros(6))
    return {"x": record["joints"], "p": record["poses"], **changes}


def test_units_are_brought_to_si():
    column = {"column": "p", "unit": "mm"}
    poses = tables()["p"].copy()
    poses[:, :3, 3] *= 1e3
    found = read_arm("run", tables(p=poses), described(poses=column))
    np.testing.assert_allclose(found["poses"], tables()["p"], atol=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"p": np.zeros((80, 3))}, "poses are not matrices"),
        ({"x": np.zeros((5, 6)), "p": np.tile(np.eye(4), (5, 1, 1))}, "too few postures"),
        ({"x": np.full((80, 6), 90.0)}, "deg recorded as rad"),
        ({"p": np.tile(np.diag([2.0, 1.0, 1.0, 1.0]), (80, 1, 1))}, "no rotation"),
        ({"p": measured(np.zeros(6))["poses"] * np.r_[1.0, 1.0, 1.0, 1e3]}, "mm recorded as m"),
    ],
)
def test_records_no_answer_could_rest_on_are_named(changes, words):
    with pytest.raises(MachineError, match=words):
        read_arm("run", tables(**changes), described())
