"""The benches over drawn machines: what a record does not show, and what causes foretell of another motion."""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "bench"))
from drawn_machines import drawn_axis, rows_of, told
from predicts import ALIKE, HALF, predicted
from true_structure import powerless


def test_a_cause_without_power_is_one_that_the_true_structure_does_not_see():
    """A log of 200 Hz has three samples of the rise of friction in each reversal, under noise."""
    assert powerless(drawn_axis(3000)) == {"stribeck_friction"}
    assert powerless(drawn_axis(3003)) == set()


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
