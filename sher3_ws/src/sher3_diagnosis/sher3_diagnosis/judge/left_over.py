"""Which gaps are left under a fit, and how much of one may be left when its cause is known."""

from __future__ import annotations

from collections.abc import Collection

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.localise.gaps import gap_of
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.thresholds import REMAINDER, REMAINDER_OF_COMPLETE, SMALL_REMAINDER, SMALL_SHARE


def left_over(gaps: Collection[Channel], evidence: Evidence, current: Fit) -> dict[Channel, float]:
    """Return the gaps that remain under a fit: channel -> excess loss.

    A known cause may leave a share of its gap, and less of it where its law is one that machines follow closely.
    """
    out: dict[Channel, float] = {}
    for channel, now in down_to_floor(gaps, evidence, current).items():
        null, small = evidence.excess(channel), now < SMALL_REMAINDER * evidence.samples(channel)
        if null <= 0.0 or now > (SMALL_SHARE if small else _share(channel, evidence, current)) * null:
            out[channel] = now
    return out


def _share(channel: Channel, evidence: Evidence, current: Fit) -> float:
    """Return the share of a gap that its causes so far may leave."""
    causes = [t.effect for t in current.terms[len(evidence.nuisance) :] if channel in t.channels]
    return REMAINDER_OF_COMPLETE if causes and not any(e.leaves_out for e in causes) else REMAINDER


def down_to_floor(gaps: Collection[Channel], evidence: Evidence, current: Fit) -> dict[Channel, float]:
    """Return the gaps that remain under a fit when nothing may be left: channel -> excess loss."""
    out: dict[Channel, float] = {}
    for channel in gaps:
        gap = gap_of(evidence, channel, residual_after(evidence, current, channel))
        if gap is not None and gap.significant:
            out[channel] = max(1.0, evidence.excess(channel, current))
    return out
