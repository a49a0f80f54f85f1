"""Where on an axis a gap lives, and what is left of it looks like, in words; the engine's own, shown one axis."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

from sher3_gap.channels import Channel
from sher3_gap.evidence import Evidence
from sher3_gap.fitting import Fit
from sher3_gap.machines.axis_evidence import AxisEvidence
from sher3_gap.machines.axis_view import SEEN_AS
from sher3_gap.quantify import residual_after
from sher3_gap.regimes import regime
from sher3_gap.signals import DECIMATED_RATE
from sher3_gap.signature import ceiling, dominant_frequency


def regime_of(evidence: AxisEvidence, channel: Channel) -> str:
    """Regimes in which the gap is largest."""
    seen, place = _seen(evidence, channel)
    return regime(seen, place)


def remainder_of(evidence: AxisEvidence, channel: Channel, after: Fit) -> str:
    """What no effect explains: regimes, frequency, and the share that a free function of the inputs closes."""
    seen, place = _seen(evidence, channel)
    left = residual_after(cast(Evidence, evidence), after, channel)
    parts = [f"largest {regime(seen, place)}"]
    frequency, share = dominant_frequency(list(left.values()))
    if share > 0.15:
        run = evidence.runs[0]
        scale = 1.0 / (run.stride * run.period) / DECIMATED_RATE
        parts.append(f"{share:.0%} of its power near {frequency * scale:.2g} Hz")
    parts.append(f"a free function of the inputs closes {ceiling(seen, place, left):.0%}")
    return "; ".join(parts)


def _seen(evidence: AxisEvidence, channel: Channel) -> tuple[Evidence, Channel]:
    """The evidence with the axis under the name the engine's words are made for."""
    place = Channel(channel.stage, SEEN_AS)
    residuals = [{place: r[channel]} if channel in r else {} for r in evidence.data.residuals]
    floors = [{place: f[channel]} if channel in f else {} for f in evidence.floors]
    data = SimpleNamespace(residuals=residuals)
    seen = SimpleNamespace(data=data, floors=floors, views=evidence.views, robot=evidence.records[0].robot)
    return cast(Evidence, seen), place
