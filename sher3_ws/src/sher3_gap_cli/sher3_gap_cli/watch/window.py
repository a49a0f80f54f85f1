"""The last seconds of a robot's joint states and commands, as arrays that a diagnosis takes."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sher3_gap_cli.watch.trajectory import Point, set_points

Array = NDArray[np.float64]
SHORTEST = 0.5
"""Share of the window from which it is diagnosed: a robot that has only just begun says little."""


EARLY = 0.2
"""Share of a period by which a sample may come early and be kept: drivers' clocks jitter."""


class State(NamedTuple):
    """Joint states at a stamp, s; rad or m, N m or N; no efforts: empty."""

    stamp: float
    position: tuple[float, ...]
    effort: tuple[float, ...]


class Command(NamedTuple):
    """Command of the joints from a stamp on, s."""

    stamp: float
    values: tuple[float, ...]


class Taken(NamedTuple):
    """A window: stamps (n,), s from its begin; command, position, effort (n, k), None where there is none."""

    time: Array
    command: Array | None
    position: Array
    effort: Array | None


class Window:
    """Keeps the last seconds of the joints of a model.

    Args:
        joints: in the order of the model.
        seconds: that are kept.
        rate: samples per second that are kept at most, Hz: what is faster is passed over.
    """

    def __init__(self, joints: Sequence[str], seconds: float, rate: float) -> None:
        self.joints, self.seconds, self.period = tuple(joints), seconds, 1.0 / rate
        self.states: deque[State] = deque()
        self.commands: deque[Command] = deque()
        self.heard, self.strange = 0, 0
        self.lacking: tuple[str, ...] = ()

    def due(self, stamp: float) -> bool:
        """Return whether a state of this stamp would be kept."""
        since = stamp - self.states[-1].stamp if self.states else 0.0
        return not self.states or since < 0.0 or since >= (1.0 - EARLY) * self.period

    def state(self, stamp: float, names: Sequence[str], position: Sequence[float], effort: Sequence[float]) -> None:
        """Take joint states; joints that the model lacks are ignored, and so is a state without any of its joints."""
        self.heard += 1
        if self.states and stamp < self.states[-1].stamp:  # the clock went back: another run
            self.states.clear()
            self.commands.clear()
        if not self.due(stamp):
            return
        places = {name: i for i, name in enumerate(names)}
        if not set(self.joints) <= set(places) or len(position) < len(names):
            self.strange += 1
            self.lacking = tuple(name for name in self.joints if name not in places)
            return
        order = [places[name] for name in self.joints]
        efforts = tuple(effort[i] for i in order) if len(effort) == len(names) else ()
        self.states.append(State(stamp, tuple(position[i] for i in order), efforts))
        while self.states[0].stamp < stamp - self.seconds:
            self.states.popleft()

    def command(self, stamp: float, names: Sequence[str], values: Sequence[float], now: float | None = None) -> None:
        """Take a command from `stamp` on; without names it is in the order of the model. It may lie ahead of `now`."""
        known: Mapping[str, float] = dict(zip(names or self.joints, values, strict=False))
        if not set(self.joints) <= set(known):
            self.strange += 1
            return
        self.commands.append(Command(stamp, tuple(known[name] for name in self.joints)))
        oldest = (stamp if now is None else now) - self.seconds
        while len(self.commands) > 1 and self.commands[1].stamp < oldest:
            self.commands.popleft()

    def trajectory(self, stamp: float, names: Sequence[str], points: Sequence[Point]) -> None:
        """Take a trajectory that starts at `stamp`; it takes the place of what was planned beyond. None: it stops."""
        while self.commands and self.commands[-1].stamp >= stamp:
            self.commands.pop()
        known = dict(zip(self.joints, self._last(), strict=True))
        if not points or not set(names) <= set(known) or any(len(p.position) != len(names) for p in points):
            self.strange += bool(points)
            return
        after, values = set_points(points, [known[name] for name in names], self.period)
        for late, row in zip(after.tolist(), values.tolist(), strict=True):
            target = {**known, **dict(zip(names, row, strict=True))}
            self.command(stamp + late, self.joints, [target[name] for name in self.joints], now=stamp)

    def _last(self) -> Sequence[float]:
        """Return the set-point in force, the measured place before the first one, zeros before anything was heard."""
        if self.commands:
            return self.commands[-1].values
        return self.states[-1].position if self.states else [0.0] * len(self.joints)

    def waits_for(self, topic: str) -> str:
        """Return why there is nothing to judge yet; `topic` is that of the joint states."""
        if self.states:
            return f"gathering the first {SHORTEST * self.seconds:g} s"
        if self.lacking:
            return f"joint states on {topic} lack {', '.join(self.lacking)}: name the joints to watch, --joint"
        return f"waiting for joint states on {topic}"

    def taken(self) -> Taken | None:
        """Return the window; None while it is shorter than half of what is kept."""
        states = list(self.states)
        if not states or states[-1].stamp - states[0].stamp < SHORTEST * self.seconds:
            return None
        stamps = np.array([s.stamp for s in states])
        position = np.array([s.position for s in states])
        efforts = [s.effort for s in states]
        effort = np.array(efforts) if all(efforts) else None
        if effort is not None and not (np.isfinite(effort).all() and effort.any()):
            effort = None
        command = self._held(stamps)
        first = 0 if command is None else int(np.argmax(np.isfinite(command[:, 0])))
        cut = [None if x is None else x[first:] for x in (command, effort)]
        return Taken(stamps[first:] - stamps[first], cut[0], position[first:], cut[1])

    def _held(self, stamps: Array) -> Array | None:
        """Return the command that was in force at each stamp (n, k), NaN before the first; None without commands."""
        if not self.commands:
            return None
        known = list(self.commands)
        at = np.searchsorted([c.stamp for c in known], stamps, side="right") - 1
        rows = np.array([[math.nan] * len(self.joints), *(c.values for c in known)])
        return rows[at + 1]
