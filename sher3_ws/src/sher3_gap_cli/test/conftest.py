"""Make the simulated cases of the SHER's own tests, of other machines, and of these tests importable."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
MACHINES = HERE.parents[1] / "sher3_machines" / "test"
sys.path[:0] = [str(x) for x in (HERE, HERE.parents[1] / "sher3_gap" / "test", MACHINES, MACHINES / "records")]
