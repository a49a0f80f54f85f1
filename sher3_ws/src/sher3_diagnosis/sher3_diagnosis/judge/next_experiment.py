"""The next experiment: which excitation of the standard set best tells the rivals of a cause apart."""

from __future__ import annotations

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.verdict import NextExperiment


def next_experiment(evidence: Evidence, attribution: Attribution) -> NextExperiment | None:
    """Propose an excitation for the first cause with rivals; None when no cause has one.

    The predicted separation is the difference in held-out loss per sample of the recorded runs, in squares of the
    floor: what one more sample of the kind at hand would add.
    """
    for i, rivals in enumerate(attribution.rivals):
        if not rivals:
            continue
        chosen, closest = attribution.fit.terms[i], rivals[0].terms[-1].effect
        ids = list(dict.fromkeys([chosen.effect.id, *(f.terms[-1].effect.id for f in rivals)]))
        best = (closest if len(ids) > 1 else chosen.effect).best
        samples = sum(evidence.samples(c) for c in chosen.channels)
        separation = min(f.total for f in rivals) - attribution.fit.total
        return NextExperiment(
            excitation=best.excitation,
            purpose=best.why,
            separates=ids,
            predicted_separation=max(0.0, separation / max(1, samples)),
        )
    return None
