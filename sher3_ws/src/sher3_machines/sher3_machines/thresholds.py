"""The numbers that decide on other machines, beside the engine's own: meaning, data they were set on, how to measure.

"Published sets" are those of docs/reference/real-data.md; `sher3 gap import` and `sher3 gap diagnose` print their
verdicts, and `test/test_real.py` holds them against what is known of each machine. None was tuned to one of them.
"""

from __future__ import annotations

# -- evidence: what takes the place of runs ------------------------------------------------------------------------

BLOCKS = 8
"""Blocks that held-out losses and intervals are taken over where nothing was repeated: as many as the SHER's standard
set has runs, so that the engine's prices mean the same. Set by that argument."""

# -- a serial arm --------------------------------------------------------------------------------------------------

FOLDS = 10
"""Folds of the postures, of which each is held out in turn. Set by custom.
Measure: `pytest sher3_ws/src/sher3_machines/test/arm`."""

WORST = 20
"""One posture in so many is among the worst, of which the notes tell the share of the error: 5 %."""
