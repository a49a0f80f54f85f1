"""The floor of repeats: half the mean square difference of pairs with one excitation."""

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel, Residual
from sher3_diagnosis.localise.floors import ENOUGH, relieved_rms, repeat_floors

C = Channel("drive", "axis")
N = 2 * ENOUGH


def run(value, free_mean=0.0):
    return {C: Residual(np.full((N, 1), value), np.ones(N, dtype=bool), free_mean)}


def test_pairs_of_one_excitation_give_half_the_square_of_their_difference():
    """Runs at 0, 2 and 4 differ by 2, 4 and 2: mean square 8, half of it 4."""
    assert repeat_floors(["a"] * 3, [run(0.0), run(2.0), run(4.0)])[C] == pytest.approx([2.0])


def test_runs_of_different_excitations_are_no_pair():
    assert repeat_floors(["a", "b"], [run(0.0), run(2.0)]) == {}


def test_a_free_mean_is_no_difference():
    assert repeat_floors(["a", "a"], [run(0.0, 1.0), run(2.0, 1.0)])[C] == pytest.approx([0.0])


def test_too_few_shared_samples_tell_no_floor():
    few = {C: Residual(np.zeros((ENOUGH, 1)), np.ones(ENOUGH, dtype=bool))}
    assert repeat_floors(["a", "a"], [few, few]) == {}


def test_rms_of_a_relieved_residual():
    assert relieved_rms(run(3.0)[C]) == pytest.approx([3.0])
    assert relieved_rms(run(3.0, 1.0)[C]) == pytest.approx([0.0])
