"""How often this machine stands still: a bare timer on every core, above all other priorities, notes when it is late.

A virtual machine is stopped by its host for a millisecond and more, a dozen times a minute or a hundred, and no program
in it can keep a cycle of 1 kHz meanwhile. A cycle that the loop lost while such a timer was late is the machine's; one
that it lost while all timers were on time is its own. A timer wakes twice a millisecond and takes 3 % of its core.

    python bench/pauses.py [--seconds 60] [--json]
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from itertools import chain

from sher3_runtime.clock import set_timer_slack

PERIOD = 500_000
"""Of a timer [ns]: a pause of 1 ms makes it late by half of that at least."""
LATE = 250_000
"""A timer that is later than this [ns] is a pause: of 120 000 in a minute some fifty are, on a quiet machine."""
PRIORITY = 80
"""Of a timer under SCHED_FIFO; the loop has 40."""

Pause = tuple[int, int]
"""Begin and end in system time [ns]: when the timer was due, and when it came."""


def watch(core: int, seconds: float) -> Iterator[Pause]:
    """Yield the pauses of a core as they end, for so many seconds."""
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    os.sched_setaffinity(0, {core})
    set_timer_slack()
    due = time.time_ns()
    end = due + round(seconds * 1e9)
    while due < end:
        due += PERIOD
        time.sleep(max(0, due - time.time_ns()) * 1e-9)
        late = (now := time.time_ns()) - due
        if late > LATE:
            yield due, now
        due += max(late, 0) // PERIOD * PERIOD


@contextlib.contextmanager
def beside(seconds: float) -> Iterator[list[Pause]]:
    """Watch every core while the block runs, at most for so many seconds; the list is full when the block has ended."""
    found: list[Pause] = []
    command = [sys.executable, __file__, "--seconds", f"{seconds:g}", "--core"]
    timers = [
        subprocess.Popen([*command, str(core)], stdout=subprocess.PIPE, text=True) for core in os.sched_getaffinity(0)
    ]
    try:
        yield found
    finally:
        for timer in timers:
            timer.terminate()
        lines = chain.from_iterable(timer.communicate()[0].splitlines() for timer in timers)
        found += [tuple(json.loads(line)) for line in lines]


def unexplained(stamps: list[int], period: int, pauses: list[Pause]) -> int:
    """Return how many of the lost cycles [ns] lie farther than a period from every pause."""
    return sum(not any(begin - period < stamp < end + period for begin, end in pauses) for stamp in stamps)


def main() -> None:
    """Watch, and print how long the pauses were."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--core", type=int, help="watch this one alone, and print begin and end of each pause [ns]")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.core is not None:
        for pause in watch(options.core, options.seconds):
            print(json.dumps(pause), flush=True)
        return
    with beside(options.seconds) as pauses:
        time.sleep(options.seconds)
    lengths = [(end - begin) / 1e6 for begin, end in pauses]
    counts = {f"{most:g} ms": sum(length > most for length in lengths) for most in (0.25, 0.5, 1.0, 2.0, 5.0)}
    text = "\n".join(f"later than {most:>7}: {count} times" for most, count in counts.items())
    print(json.dumps({"seconds": options.seconds, "later_than": counts}) if options.json else text)


if __name__ == "__main__":
    main()
