"""Make the simulated cases of the SHER's own tests, of other machines, and of these tests importable."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
SHER, CHAINS, STATIC = (HERE.parents[1] / f"sher3_{room}" / "test" for room in ("gap", "chain", "static"))
sys.path[:0] = [str(x) for x in (HERE, SHER, CHAINS, CHAINS / "records", STATIC)]
