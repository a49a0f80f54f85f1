"""Puts the verdicts of these tests, and the simulated slide of the tests of chains, within reach."""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path += [str(folder) for folder in (HERE, HERE.parents[1] / "sher3_chain" / "test")]
