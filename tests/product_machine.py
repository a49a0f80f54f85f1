"""The product of every state machine that decides about motion, explored exhaustively over the code that runs.

Supervisor x driver x five CiA 402 drives x pedal and arming of the law: `World` wires the real parts as the nodes do
(the driver node's own glue included) and moves them by one event and one control period at a time. Only times are
shortened: how long a robot brakes, and for how long an old report is not taken up again; and the force has no dead
band, so that motion begins in the tick it is allowed in.

    python tests/product_machine.py [--json] [--drive tilt]        # states, transitions, seconds
"""

from __future__ import annotations

import argparse
import json
import time
from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from product_world import EVENTS, World
from sher3_description import ACTUATORS


@dataclass
class Exploration:
    """The reachable states, numbered, and every transition between them.

    Attributes:
        keys: of the states; state 0 is the start.
        edges: (from, event, to).
        seconds: it took.
    """

    keys: list[tuple[Any, ...]] = field(default_factory=list)
    edges: list[tuple[int, str, int]] = field(default_factory=list)
    seconds: float = 0.0

    def can_reach(self, goals: set[int], events: frozenset[str] | None = None) -> set[int]:
        """Return the states from which a goal can be reached, by all events or by these alone."""
        before: dict[int, list[int]] = {}
        for source, event, target in self.edges:
            if events is None or event in events:
                before.setdefault(target, []).append(source)
        found, waiting = set(goals), deque(goals)
        while waiting:
            for source in before.get(waiting.popleft(), ()):
                if source not in found:
                    found.add(source)
                    waiting.append(source)
        return found


Transition = tuple[World, str, World, bool]


def explore(drive: int = 0, events: Sequence[str] = EVENTS, limit: int = 100_000) -> Iterator[Transition | Exploration]:
    """Yield every transition as (world before, event, world after, accepted), breadth first; the exploration last."""
    begin, start = time.monotonic(), World(drive)
    for _ in range(3):
        start.step("tick")  # the first statuswords
    result = Exploration([start.key()])
    number, waiting = {start.key(): 0}, deque([start.freeze()])
    for here in range(limit):
        if not waiting:
            break
        frozen = waiting.popleft()
        world = World.thaw(frozen)
        for event in events:
            after = World.thaw(frozen)
            accepted = after.step(event)
            key = after.key()
            if key not in number:
                number[key] = len(number)
                result.keys.append(key)
                waiting.append(after.freeze())
            result.edges.append((here, event, number[key]))
            yield world, event, after, accepted
    assert not waiting, f"more than {limit} states"
    result.seconds = time.monotonic() - begin
    yield result


def main() -> None:
    """Explore and print the numbers."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--drive", choices=ACTUATORS, default=ACTUATORS[0])
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    *_, result = explore(ACTUATORS.index(options.drive))
    assert isinstance(result, Exploration)
    data = {"drive": options.drive, "states": len(result.keys), "transitions": len(result.edges)}
    data["seconds"] = round(result.seconds, 1)
    print(json.dumps(data) if options.json else "  ".join(f"{k} {v}" for k, v in data.items()))


if __name__ == "__main__":
    main()
