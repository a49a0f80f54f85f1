"""How far runs separate a cause from its rivals, each refitted to the same runs: what decides, in floors.

The same judge serves simulated runs, which gives a prediction, and recorded ones, which gives what was realised.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from sher3_description import Robot
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.fit.fitting import Fit, Standardised
from sher3_diagnosis.thresholds import NEEDED, RIVAL
from sher3_effects import library

from sher3_gap.evidence import SherEvidence, gather
from sher3_gap.signals import RunSignals
from sher3_gap.stages.floors import Floors


@dataclass(frozen=True)
class Separation:
    """How far runs separate the cause from its closest rival, both refitted.

    Attributes:
        floors: rms difference of the two refitted models in units of the floor.
        margin: the difference in held-out loss over what the diagnosis asks for; above 1 the rival is ruled out.
        closest: the rival that remains closest.
    """

    floors: float
    margin: float
    closest: str


@dataclass(frozen=True)
class Prediction:
    """Separations of one excitation over draws of parameters, noise and scatter."""

    draws: tuple[Separation, ...]

    @property
    def floors(self) -> float:
        """Mean over the draws."""
        return float(np.mean([d.floors for d in self.draws]))

    @property
    def spread(self) -> float:
        """Standard deviation over the draws; 0 with a single one."""
        return float(np.std([d.floors for d in self.draws], ddof=1)) if len(self.draws) > 1 else 0.0

    @property
    def margin(self) -> float:
        """Mean over the draws of what rules the closest rival out; above 1 it does."""
        return float(np.mean([d.margin for d in self.draws]))

    @property
    def resolved(self) -> float:
        """Share of the draws in which every rival is ruled out."""
        return float(np.mean([d.margin > 1.0 for d in self.draws]))

    @property
    def closest(self) -> str:
        """The rival that is closest most often."""
        names = [d.closest for d in self.draws]
        return max(dict.fromkeys(names), key=names.count)


def separation(
    runs: Sequence[RunSignals],
    robot: Robot,
    cause: tuple[str, str],
    rivals: Sequence[str],
    floor: Mapping[Channel, np.ndarray] | None = None,
) -> Separation:
    """Refit a cause (effect, actuator) and its rivals to runs and say how far apart they end.

    Args:
        runs: two or more, so that each is scored with coefficients of the others.
        robot: the nominal model.
        cause: effect id and actuator.
        rivals: effect ids.
        floor: floors of another case that are not undercut, per channel (d,).
    """
    evidence = gather(runs, robot)
    if floor:
        evidence = _with_floors(evidence, floor)
    candidates = Candidates(evidence, list(library().values()))
    own = candidates.best(library()[cause[0]], cause[1])
    if own is None:
        return Separation(0.0, 0.0, rivals[0])
    losses = {rival: _loss(candidates, rival, own) for rival in rivals}
    closest = min(losses, key=losses.__getitem__)
    behind = losses[closest] - own.total
    worth = sum(evidence.data.null_loss.values()) - own.total
    samples = _samples(evidence, own.terms[-1].channels)
    return Separation(
        float(np.sqrt(max(behind, 0.0) / max(samples, 1))), float(behind / max(NEEDED, RIVAL * worth)), closest
    )


def floors_of(evidence: SherEvidence) -> Floors:
    """Return the floor of a case per channel, (d,): the median over its runs."""
    channels = {channel for run in evidence.floors for channel in run}
    return {c: np.median([f[c] for f in evidence.floors if c in f], axis=0) for c in channels}


def _with_floors(evidence: SherEvidence, least: Mapping[Channel, np.ndarray]) -> SherEvidence:
    data = evidence.data
    raised = [{c: np.maximum(f, least[c]) if c in least else f for c, f in run.items()} for run in data.floors]
    return replace(evidence, data=Standardised(data.views, data.residuals, raised))


def _loss(candidates: Candidates, rival: str, own: Fit) -> float:
    """Return the least held-out loss of a rival, at any site where it shows in the cause's channels."""
    effect = library()[rival]
    channels = own.terms[-1].channels
    sites = [s for s in candidates.sites(effect) if set(effect.channels(s)) & set(channels)]
    fits = [f for s in sites if (f := candidates.best(effect, s)) is not None]
    return min((f.total for f in fits), default=float("inf"))


def _samples(evidence: SherEvidence, channels: Iterable[Channel]) -> int:
    return sum(n for (_, c), n in evidence.data.samples.items() if c in set(channels))
