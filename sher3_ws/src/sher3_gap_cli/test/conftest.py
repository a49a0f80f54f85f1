"""Make the simulated cases of the SHER's own tests importable."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "sher3_gap" / "test"))
