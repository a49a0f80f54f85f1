"""The numbers that decide on tables of readings, beside the engine's own: meaning, how set, how to measure."""

from __future__ import annotations

FOLDS = 10
"""Folds of the postures, of which each is held out in turn. Set by custom.
Measure: `pytest sher3_ws/src/sher3_static/test/arm`."""

WORST = 20
"""One posture in so many is among the worst, of which the notes tell the share of the error: 5 %."""
