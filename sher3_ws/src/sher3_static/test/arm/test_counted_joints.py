"""Joints that a controller counts in another sense, or with the turn of the joint before, are no error of the arm."""

import numpy as np
import pytest
from arms import machine, measured
from sher3_diagnosis import diagnose
from sher3_static.arm.counted import counted_view, in_words
from sher3_static.arm.sight import PoseSight, PositionSight
from sher3_static.readings import Readings

OFFSETS = np.array([0.0, 0.0, 8e-3, 0.0, 0.0, 0.0])


def recorded(signs, sums=(), n=50, seed=0):
    """Poses of an arm whose third joint reads 8 mrad too much, counted by another custom, and the custom undone."""
    run = measured(OFFSETS, n, seed)
    undo = np.diag(np.asarray(signs, dtype=float))
    for i, j, sign in sums:
        undo[i, j] = sign
    return Readings("run", {**run.columns, "joints": run["joints"] @ np.linalg.inv(undo).T}), undo


@pytest.mark.parametrize(
    ("signs", "sums"),
    [
        ((1, 1, 1, -1, 1, 1), ()),
        ((-1, 1, 1, -1, -1, -1), ()),
        ((1, 1, -1, -1, -1, -1), ((2, 1, -1.0),)),
        ((1, -1, 1, 1, 1, 1), ((2, 1, 1.0),)),
    ],
)
def test_the_verdict_is_that_of_an_arm_that_counts_as_the_model(signs, sums):
    run, undo = recorded(signs, sums)
    view, counts = counted_view(
        machine().known.arm, run["joints"], run["poses"], np.zeros(50, int), np.repeat(2e-4, 6), PoseSight()
    )
    np.testing.assert_array_equal(counts, undo)
    np.testing.assert_allclose(view.joints, recorded(np.ones(6))[0]["joints"], atol=1e-12)


def test_it_is_said_and_the_cause_stays():
    run, _ = recorded((1, 1, -1, -1, -1, -1), ((2, 1, -1.0),))
    verdict = diagnose(machine(), [run]).verdict
    [cause] = verdict.causes
    assert (cause.effect, cause.actuator) == ("encoder_offset", "j3")
    assert cause.parameters["offset"].value == pytest.approx(8e-3, rel=0.1)
    assert "j3 is recorded with the turn of j2 in it: taken out in all runs" in verdict.notes
    assert "j3, j4, j5, j6: recorded in the other sense than the model has; turned in all runs" in verdict.notes


@pytest.mark.parametrize("size", [0.0, 0.01, 0.1])
def test_a_zero_that_is_off_is_no_custom(size):
    run = measured(size * np.ones(6), n=50)
    arm, positions = machine().known.arm, run["poses"][:, :3, 3]
    counts = counted_view(arm, run["joints"], positions, np.zeros(50, int), np.repeat(2e-4, 3), PositionSight())[1]
    np.testing.assert_array_equal(counts, np.eye(6))
    assert in_words(arm, counts) == []
