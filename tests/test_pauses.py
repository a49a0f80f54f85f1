"""The bare timer beside a bench: which lost cycles lie beside a pause of the machine."""

import runpy
from pathlib import Path

BENCH = Path(__file__).parents[1] / "bench"
MS = 1_000_000


def test_a_cycle_within_a_period_of_a_pause_is_explained():
    unexplained = runpy.run_path(str(BENCH / "pauses.py"))["unexplained"]
    pauses = [(10 * MS, 12 * MS), (50 * MS, 50 * MS + 300_000)]
    assert unexplained([9 * MS + 1, 11 * MS, 13 * MS - 1, 50 * MS], MS, pauses) == 0
    assert unexplained([8 * MS, 14 * MS, 30 * MS, 52 * MS], MS, pauses) == 4
    assert unexplained([10 * MS], MS, []) == 1
