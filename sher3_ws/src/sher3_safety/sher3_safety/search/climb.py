"""The search: draws at random, then more of them near those that moved the tip furthest."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from sher3_control.motion.speed_cap import Regime
from sher3_description import Robot, load_robot
from sher3_faults.budget import RUNAWAY

from sher3_safety.kept import Kept
from sher3_safety.search.draw import Draw, drawn, near
from sher3_safety.search.trial import Found, try_all
from sher3_safety.search.words import read

ROUND, PARENTS, CLIMBS = 25, 10, 0.6
"""Draws of a round, how many of the worst have children, and the share of children after the first round."""
EXACT = 17
"""Digits with which a number is written and read as the same one."""


@dataclass
class SearchResult:
    """What a search found, the worst first.

    Attributes:
        found: every trial.
        seed: of the draws.
    """

    found: list[Found]
    seed: int

    @property
    def missed(self) -> list[Found]:
        """The trials beyond their budget."""
        return [one for one in self.found if one.share > 1.0]

    def worst(self, number: int = 10) -> list[Found]:
        """Return the trials that came nearest to their budget, or went beyond it."""
        return sorted(self.found, key=lambda one: -one.share)[:number]

    def as_text(self) -> str:
        """Return the worst ten as a table in Markdown, under a sentence."""
        lines = [
            f"{len(self.found)} draws, seed {self.seed}: {len(self.missed)} beyond their budget.",
            "",
            "| regime | state | faults, onset [ticks] | first reason | travel [um] | budget [um] | seed |",
            "|---|---|---|---|---|---|---|",
        ]
        for one in self.worst():
            draw, travel = one.draw, one.travel * 1e6
            lines.append(f"| {draw.line()} | {one.reason} | {travel:.1f} | {draw.budget * 1e6:g} | {one.seed} |")
        return "\n".join(lines)

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        rows = [
            {"regime": one.draw.regime.value, "state": one.draw.state.name, "faults": one.draw.in_words(),
             "reason": one.reason, "travel": one.travel, "budget": one.draw.budget, "seed": one.seed}
            for one in self.worst(len(self.found))
        ]  # fmt: skip
        return {"seed": self.seed, "draws": len(rows), "missed": len(self.missed), "trials": rows}


def search(
    trials: int,
    seed: int = 1,
    robot: Robot | None = None,
    say: Callable[[str], None] = lambda _: None,
    kept: Path | None = None,
) -> SearchResult:
    """Try so many draws, in rounds of one regime each.

    Args:
        trials: number of draws, with those that are kept.
        seed: of the draws, and of the noise of the robot. Each round has its own stream of it, so that a search that
            was ended goes on as it would have.
        robot: nominal by default.
        say: prints progress.
        kept: folder of what earlier searches of the seed tried, and of what this one tries.
    """
    robot, regimes, store = robot or load_robot(), list(RUNAWAY), Kept(kept, f"draws-{seed}.jsonl")
    result = SearchResult([_found(entry) for entry in store.before()], seed)
    while len(result.found) < trials:
        number = len(result.found) // ROUND
        regime, count = regimes[number % len(regimes)], min(ROUND, trials - len(result.found))
        draws = _next(Random(f"{seed} {number}"), regime, count, result)
        tried = [_entry(found) for found in try_all(draws, robot, seed + number)]
        store.add(tried)
        result.found += [_found(entry) for entry in tried]  # as they will be read, so that a search goes on as it would
        worst = result.worst(1)[0]
        sizes = f"{worst.travel * 1e6:.1f} um of {worst.draw.budget * 1e6:g}"
        say(f"{len(result.found)} draws, worst {sizes}, {worst.draw.state.name}: {worst.draw.in_words()}")
    return result


def _entry(found: Found) -> dict[str, Any]:
    return {"draw": found.draw.line(EXACT), "travel": found.travel, "reason": found.reason, "seed": found.seed}


def _found(entry: dict[str, Any]) -> Found:
    return Found(read(entry["draw"]), entry["travel"], entry["reason"], entry["seed"])


def again(draws: Sequence[Draw], seed: int = 1, robot: Robot | None = None) -> SearchResult:
    """Try some draws on a robot of that seed."""
    return SearchResult(try_all(draws, robot or load_robot(), seed), seed)


def _next(random: Random, regime: Regime, count: int, result: SearchResult) -> list[Draw]:
    """Return the draws of the next round of a regime."""
    known = SearchResult([one for one in result.found if one.draw.regime is regime], result.seed).worst(PARENTS)
    return [
        near(random, random.choice(known).draw) if known and random.random() < CLIMBS else drawn(random, regime)
        for _ in range(count)
    ]
