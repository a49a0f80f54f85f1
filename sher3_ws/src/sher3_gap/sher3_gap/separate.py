"""The next experiment: which excitation of the standard set best tells the rivals of a cause apart."""

from __future__ import annotations

from sher3_gap.attribute import Attribution
from sher3_gap.evidence import Evidence
from sher3_gap.verdict import NextExperiment

BEST_FOR = {
    "friction": ("reversals", "reversals of several amplitudes and speeds separate friction laws"),
    "timing": ("steps", "steps of several amplitudes show a dead time as an onset and a lag as a slope"),
    "scale": ("sweep", "long constant-speed strokes separate ratios from offsets"),
    "limit": ("steps", "large and small steps separate limits from lags"),
    "inertia": ("steps", "accelerations separate mass from weight"),
    "periodic": ("sweep", "constant speeds over several revolutions separate periods"),
    "lost_motion": ("loads", "known loads at rest separate a fixed gap from a spring"),
    "compliance": ("loads", "known loads in several postures separate springs"),
    "geometry": ("postures", "well-spread postures separate geometric errors"),
    "drift": ("postures", "the same postures again at another temperature separate drift from offset"),
    "wrench": ("loads", "known loads in several orientations separate bias, weight and cross-talk"),
}
"""Family -> excitation of the standard set and why."""


def next_experiment(evidence: Evidence, attribution: Attribution) -> NextExperiment | None:
    """Propose an excitation for the cause with the closest rivals; None when no rival is left."""
    for i, rivals in enumerate(attribution.rivals):
        if rivals:
            chosen = attribution.fit.terms[i].effect
            ids = list(dict.fromkeys([chosen.id, *(f.terms[-1].effect.id for f in rivals)]))
            name, why = BEST_FOR[rivals[0].terms[-1].effect.family if len(ids) > 1 else chosen.family]
            samples = sum(n for (_, c), n in evidence.data.samples.items() if c in attribution.fit.terms[i].channels)
            separation = min(f.total for f in rivals) - attribution.fit.total
            return NextExperiment(
                excitation=name, purpose=why, separates=ids, predicted_separation=max(0.0, separation / max(1, samples))
            )
    return None
