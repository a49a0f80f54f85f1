"""The benches over drawn machines: what a record does not show, and what causes foretell of another motion."""

import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
from drawn_machines import drawn_axis, rows_of, told
from predicts import ALIKE, HALF, predicted
from true_arm import Motion, powerless_on
from true_structure import powerless


def test_a_cause_without_power_is_one_that_the_true_structure_does_not_see():
    """A log of 200 Hz has three samples of the rise of friction in each reversal, under noise."""
    assert powerless(drawn_axis(3000)) == {"stribeck_friction"}
    assert powerless(drawn_axis(3003)) == set()


def test_a_cause_of_an_arm_without_power_is_one_that_its_forces_do_not_show():
    """Two joints, of which the first has a viscous friction alone; a rotor of the second one is a millionth."""
    clock = np.arange(0.0, 10.0, 0.005)
    q = np.column_stack([np.sin(2.0 * clock), np.sin(3.0 * clock + 1.0)])
    v, a = np.gradient(q, 0.005, axis=0), np.gradient(np.gradient(q, 0.005, axis=0), 0.005, axis=0)
    left = np.column_stack([0.5 * v[:, 0], 1e-6 * a[:, 1]]) + 0.01 * np.random.default_rng(0).normal(size=q.shape)
    causes, names = [("viscous", 0), ("rotor", 1), ("payload", 1)], ["viscous first", "rotor second", "payload"]
    carried = np.column_stack([np.cos(q[:, 0]), np.cos(q.sum(axis=1))])
    assert powerless_on(Motion(q, v, a, left, 0.005), carried, causes, names) == {"rotor second", "payload"}


def test_kept_results_are_taken_and_misses_without_power_are_counted_apart(tmp_path):
    row = {"kind": "axis", "seed": 1, "seconds": 1.0, "status": "attributed", "held": [True], "impossible": []}
    row |= {"truth": ["a", "b", "c"], "powerless": ["b"], "sher3": [["a"], ["x"]], "lasso": [["a"]]}
    kept = tmp_path / "kept.jsonl"
    kept.write_text(json.dumps(row) + "\n")
    page = told("axis", rows_of("axis", range(1, 2), kept))
    assert "recall 0.333" in page and "of what has power 0.500" in page and "precision 0.500" in page
    assert "missed {'c': 1}, for lack of power {'b': 1}, wrong {'x': 1}" in page


def test_causes_foretell_the_force_in_a_motion_held_out():
    """Friction that falls with speed and a late effort: all plain columns leave a quarter of the gap."""
    found = predicted(drawn_axis(3003), drawn_axis(3003, motion=1))
    assert found.causes <= HALF * found.wrong and found.causes <= ALIKE * found.true
