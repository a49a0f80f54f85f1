"""One plant left out at a time: statuses, rates and reliability on a plant that nothing was set on."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.finding import LIBRARY, Candidate, Item, Judged
from sher3_diagnosis.judge.calibration.calibration import Calibration
from sher3_diagnosis.judge.costs import DEFAULT, Costs
from sher3_diagnosis.judge.evidence.scales import scaled_exact
from sher3_diagnosis.judge.probabilities import judged_together
from sher3_diagnosis.judge.status import answer_to, answer_to_exact, status_of
from sher3_diagnosis.verdict import Interval

from sher3_challenge.calibration.fit import calibrated
from sher3_challenge.calibration.labels import (
    alike,
    answer_of,
    company,
    contains,
    equal,
    known_effects,
    same_data,
    twins,
)
from sher3_challenge.calibration.observe import Observation
from sher3_challenge.plants.level import BUILT, SHAPE
from sher3_challenge.score.reliability import Stated


@dataclass(frozen=True)
class Judgement:
    """The judgement of one observation by a calibration that did not see its plant.

    Attributes:
        seen: the observation.
        said: status.
        named: the effects of the causes that are listed; `sets`: each with its rivals.
        right: per cause and gap whose answer the label settles, the probability of each answer and whether it is the
            right one.
        causes: per cause whose answer the label settles, the probability that it is the library's, and whether it is.
        excused: an effect left out was answered by effects that explain the same data: nothing recorded tells.
        rightly_named: the engine found a true effect, whatever the status.
    """

    seen: Observation
    said: str
    named: tuple[str, ...]
    sets: tuple[frozenset[str], ...]
    right: tuple[Stated, ...]
    causes: tuple[Stated, ...]
    excused: bool
    rightly_named: bool

    @property
    def single(self) -> bool:
        """Whether one effect of the library is to be named."""
        return self.seen.truth["status"] == "attributed" and len(self.seen.truth["effects"]) == 1

    @property
    def first_right(self) -> bool | None:
        """Whether the first cause of a single fault, but for its company, is the true one; None without a cause."""
        own = [name for name in self.named if name not in company(self.seen) or equal(name, known_effects(self.seen))]
        return equal(own[0], known_effects(self.seen)) if self.single and own else None

    @property
    def in_set(self) -> bool | None:
        """Whether the set of a cause of a single fault holds the true one; None without a cause."""
        return any(s & known_effects(self.seen) for s in self.sets) if self.single and self.sets else None

    @property
    def set_size(self) -> float | None:
        """Mean number of effects in the sets of a single fault."""
        return sum(map(len, self.sets)) / len(self.sets) if self.single and self.sets else None


Group = Callable[[Observation], str | None]
"""What an observation belongs to, of a kind of groups; None where it belongs to none."""


def by_plant(seen: Observation) -> str:
    """Return the plant."""
    return seen.plant


def by_shape(seen: Observation) -> str | None:
    """Return whether the laws of its robot are close to their pages, or far from them."""
    level = seen.truth.get("level")
    return level and ("close laws" if level["shape"] < middle(SHAPE) else "bent laws")


def by_build(seen: Observation) -> str | None:
    """Return whether its robot is built well, or badly."""
    level = seen.truth.get("level")
    return level and ("built well" if level["built"] < middle(BUILT) else "built badly")


def middle(ends: tuple[float, float]) -> float:
    """Return the middle of a range, on a scale of logarithms."""
    return math.sqrt(ends[0] * ends[1])


GROUPS: tuple[Group, ...] = (by_plant, by_shape, by_build)


def groups(observations: Sequence[Observation], of: Group) -> dict[str, list[Observation]]:
    """Return the observations by their group; those that belong to none are left out."""
    names = sorted({name for o in observations if (name := of(o)) is not None})
    return {name: [o for o in observations if of(o) == name] for name in names}


Fit = Callable[[Sequence[Observation]], Calibration]


def held_out(
    observations: Sequence[Observation], of: Group = by_plant, fit: Fit = calibrated
) -> dict[str, list[Judgement]]:
    """Judge each group with a calibration fitted to all observations that are not of it; none where there is one."""
    found = groups(observations, of)
    return {
        name: judged_by(fit([o for o in observations if of(o) != name]), own)
        for name, own in found.items()
        if len(found) > 1
    }


def judged_by(calibration: Calibration, observations: Sequence[Observation], costs: Costs = DEFAULT) -> list[Judgement]:
    """Judge observations with a calibration, as verdicts are judged."""
    whole = {(o.plant, o.case): o for o in observations if not o.without}
    return [_judgement(o, whole[o.plant, o.case], calibration, costs) for o in observations]


def _judgement(seen: Observation, whole: Observation, calibration: Calibration, costs: Costs) -> Judgement:
    items = _judged(seen, calibration)
    exact = [reproduced(stage, calibration) for stage in seen.exact]
    named, sets, right, causes = [], [], [], []
    for row, j in zip(seen.items, items, strict=True):
        if answer_to(j, costs) == LIBRARY:
            named.append(row["candidates"][0]["effect"])
            sets.append(frozenset(alike(row, calibration.reach)))
        truth = answer_of(seen, row, whole)
        if truth is not None:
            right += [(p, name == truth) for name, p in j.odds.items()]
            causes += [(j.library, truth == LIBRARY)] if row["index"] is not None else []
    for stage, share in zip(seen.exact, exact, strict=True):
        if answer_to_exact(share, costs) == LIBRARY:
            named += [c["effect"] for c in stage["causes"]]
            sets += [frozenset({c["effect"]}) for c in stage["causes"]]
    found = [row["candidates"][0]["effect"] for row in seen.items if row["index"] is not None]
    found += [c["effect"] for stage in seen.exact for c in stage["causes"]]
    return Judgement(
        seen,
        status_of(items, exact, calibration.same, costs),
        tuple(named),
        tuple(sets),
        tuple(right),
        tuple(causes),
        excused=bool(seen.without and named) and _no_mistake(named, seen, whole),
        rightly_named=any(equal(name, known_effects(seen)) for name in found),
    )


def _no_mistake(named: Sequence[str], seen: Observation, whole: Observation) -> bool:
    """Whether effects contain the one left out or come with it, or explain the same data, one by one or together."""
    if same_data(seen, whole):
        return True
    return all(contains(name, seen.without) or twins(name, whole) or name in company(seen) for name in named)


def _judged(seen: Observation, calibration: Calibration) -> list[Judged]:
    """Return the items of an observation, which were kept as plain data, with their odds."""
    items = [item_of(row) for row in seen.items]
    closures = [Interval(**row["closure"]) if row.get("closure") else None for row in seen.items]
    return judged_together(items, closures, calibration, seen.own_level)


def item_of(row: Mapping[str, Any]) -> Item:
    """Return an item that was kept as plain data."""
    candidates = [Candidate(**c) for c in row["candidates"]]
    return Item(Channel(*row["channel"].split("/")), row["index"], row["numbers"], candidates)


def reproduced(stage: Mapping[str, Any], calibration: Calibration) -> float:
    """Return the probability that the causes of an exact stage are those at work; 0 without one."""
    return calibration.exact.probabilities(scaled_exact(stage["closure"]))[LIBRARY] if stage["causes"] else 0.0
