"""The numbers that decide on other machines, beside the engine's own: meaning, data they were set on, how to measure.

"Published sets" are those of docs/reference/real-data.md; `sher3 gap import` and `sher3 gap diagnose` print their
verdicts, and `test/test_real.py` holds them against what is known of each machine. None was tuned to one of them.
"""

from __future__ import annotations

# -- evidence: what takes the place of runs ------------------------------------------------------------------------

BLOCKS = 8
"""Blocks that held-out losses and intervals are taken over where nothing was repeated: as many as the SHER's standard
set has runs, so that the engine's prices mean the same. Set by that argument."""

FURTHEST = {"linear": 10.0, "rotary": 40.0}
"""Travel, m or rad, beyond which an axis without a stated range is taken for a unit slip."""
