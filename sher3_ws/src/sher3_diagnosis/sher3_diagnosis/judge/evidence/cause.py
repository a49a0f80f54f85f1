"""The evidence for one cause, as numbers that mean the same on every plant."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sher3_diagnosis.attribute.constancy import constancy_of
from sher3_diagnosis.attribute.rivals import Attribution, without_term
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.fitting import Fit, Term
from sher3_diagnosis.judge.evidence.bent import added, stray_share
from sher3_diagnosis.judge.evidence.free_law import ROWS, loss_left
from sher3_diagnosis.localise.gaps import gap_of
from sher3_diagnosis.localise.pattern import pattern_of
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.quantify.remains import excess_of, remains
from sher3_diagnosis.thresholds import AT_FLOOR


@runtime_checkable
class Felt(Protocol):
    """What a view tells of the quantities that laws of a place may depend on."""

    def quantities(self, site: str) -> Mapping[str, Array]:
        """Return quantity, of `sher3_diagnosis.effect.INPUTS`, -> (g, k) columns, as a place feels them."""


@runtime_checkable
class Recorded(Protocol):
    """What a view tells of a machine whose places may act on each other."""

    def everything(self) -> Array:
        """Return (g, k) everything that was recorded of the whole machine, with its past."""


@dataclass(frozen=True)
class CauseEvidence:
    """Evidence that one cause of a fit is at work. Shares are of the gap that the other causes leave, less its floor.

    What nothing tells is None: a limit has no coefficient, so that none could differ between excitations.

    Attributes:
        left: share left on held-out runs.
        part: that gap over the gap without any cause, at most 1.
        stray: share left that is not in proportion to what the cause adds; a bent law leaves one that is.
        law: share left once its law is a free function of the inputs that the effect's page states. Like the next one
            None on a machine whose views do not tell them.
        anything: of whatever was recorded anywhere, and its past.
        spread: relative gain from fitting each excitation separately.
        mismatch: between the regimes where the cause says the gap is and where it is: 0 to 1.
        ratio: gap over floor, with the mean of every run.
        power: of the gap over the floor, less one, of the component with most: without what a free mean takes.
        idealised: 1 where the law of a cause of this gap leaves something out (`Effect.leaves_out`), 0 where the laws
            of all are complete: what several causes leave may come from any of them.
    """

    left: float
    part: float
    stray: float
    law: float | None
    anything: float | None
    spread: float | None
    mismatch: float
    ratio: float
    power: float
    idealised: float

    def numbers(self) -> dict[str, float]:
        """Return the evidence by name, without what nothing tells."""
        return {name: x for name, x in asdict(self).items() if x is not None}


def strongest_channel(evidence: Evidence, term: Term, before: Fit, after: Fit) -> Channel:
    """Return the channel on which a term explains most."""
    shows = [c for c in sorted(term.channels) if evidence.excess(c) > 0.0] or sorted(term.channels)
    return max(shows, key=lambda c: evidence.excess(c, before) - evidence.excess(c, after))


def cause_evidence(evidence: Evidence, attribution: Attribution, index: int) -> CauseEvidence:
    """Return the evidence for one cause of an attribution."""
    found = attribution.fit
    term, without = found.terms[index], without_term(evidence, found, index)
    channel = strongest_channel(evidence, term, without, found)
    samples = evidence.samples(channel)
    gap = max(evidence.excess(channel, without), 1.0)
    moving = attribution.moving
    fitted = found if moving is None else moving.whole
    remainder = remains(evidence, fitted, index, channel)
    left, own = excess_of(evidence, channel, remainder), added(fitted, index, channel, remainder)
    has_inputs = all(isinstance(evidence.views[r], Felt) for r in remainder)
    taken = free_laws(evidence, channel, inputs_of(attribution, channel), remainder) if has_inputs else (None, None)
    law, anything = (None if x is None else (left - x * samples) / gap for x in taken)
    steady = constancy_of(evidence, found, index)
    before = residual_after(evidence, without, channel)
    whole = gap_of(evidence, channel, before)
    assert whole is not None
    return CauseEvidence(
        left=left / gap,
        part=min(1.0, gap / max(evidence.excess(channel), gap)),
        stray=left / gap * stray_share(standardised(evidence, channel, remainder), own),
        law=law,
        anything=anything,
        spread=steady.spread if steady.comparable else None,
        mismatch=1.0 - pattern_of(evidence, found, index).agreement,
        ratio=whole.ratio,
        power=power_of(evidence, channel, before),
        idealised=float(any(e.leaves_out for e in _effects_on(attribution, channel))),
    )


def power_of(evidence: Evidence, channel: Channel, left: Mapping[int, Array]) -> float:
    """Return the power over the floor of residuals {run: (N, d)} in SI units, less one, of the component with most."""
    return float(np.mean(standardised(evidence, channel, left) ** 2, axis=0).max()) - 1.0


def standardised(evidence: Evidence, channel: Channel, left: Mapping[int, Array]) -> Array:
    """Return residuals {run: (N, d)} in SI units over their floor, one run after another -> (n, d)."""
    return np.concatenate([x / evidence.floors[r][channel] for r, x in left.items()])


OF_FAMILY: Mapping[str, tuple[str, ...]] = {"friction": ("direction", "velocity")}
"""Inputs that the laws of a family share, whichever was chosen: any friction may rise or fall with the speed."""


def inputs_of(attribution: Attribution, channel: Channel) -> frozenset[str]:
    """Return the quantities that the laws of the causes of a channel depend on."""
    return frozenset(x for e in _effects_on(attribution, channel) for x in (*e.inputs, *OF_FAMILY.get(e.family, ())))


def _effects_on(attribution: Attribution, channel: Channel) -> list[Effect]:
    """Return the effects of the causes that show on a channel."""
    terms = [attribution.fit.terms[i] for i in attribution.causes]
    return [term.effect for term in terms if channel in term.channels]


def free_laws(
    evidence: Evidence, channel: Channel, inputs: Collection[str], left: Mapping[int, Array]
) -> tuple[float, float]:
    """Return the mean square over the floor, per sample and component, that free laws take off what causes leave.

    Of the inputs that their laws depend on, and of everything recorded, after all quantities of the place. `left` is
    (N, d) for each run, in the channel's unit.
    """
    white = {r: x / evidence.floors[r][channel] for r, x in left.items()}
    signal = np.concatenate(list(white.values()))
    width = signal.shape[1]
    level = float(np.mean(signal**2))
    if level < AT_FLOOR:
        return 0.0, 0.0
    step = max(1, len(signal) // ROWS)
    picked = {r: np.flatnonzero(evidence.data.residuals[r][channel].ok)[::step] for r in left}
    signal = np.concatenate([white[r][::step] for r in left])
    views = {id(v): v for v in (evidence.views[r] for r in left)}  # blocks of one record share a view
    felt = {key: v.quantities(channel.actuator) for key, v in views.items()}  # type: ignore[attr-defined]
    whole = {key: v.everything() for key, v in views.items() if isinstance(v, Recorded)}
    run = np.concatenate([np.full(len(picked[r]), list(views).index(id(evidence.views[r]))) for r in left])
    own, place, rest = [], [], []
    for r, rows in picked.items():
        known = felt[key := id(evidence.views[r])]
        others = known.keys() - set(inputs)
        own.append(_stacked(known, known.keys() - others, rows))
        place.append(_stacked(known, others - ELSEWHERE, rows))
        rest.append(whole[key][rows] if key in whole else _stacked(known, others, rows))
    before = float(np.sum(signal**2)) / len(signal)
    law, *_, anything = loss_left([np.vstack(own), np.vstack(place), np.vstack(rest)], signal, run)
    return (before - law) / width, (before - anything) / width


ELSEWHERE = frozenset({"time", "temperature", "posture"})
"""Quantities that are no place's own; at the tip the posture is in everything that was recorded."""


def _stacked(columns: Mapping[str, Array], names: Collection[str], rows: NDArray[np.int64]) -> Array:
    parts = [x[rows] for name, x in columns.items() if name in names]
    return np.hstack(parts) if parts else np.zeros((len(rows), 0))
