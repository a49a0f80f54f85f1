"""What the numbers of a column say: whether it is a clock, in which unit it is, and how fine its encoder is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.localise.floors import noise_of_bends

from sher3_machines.drafting.names import bare_and_unit, counts_samples, parse, tells_time
from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import TIME_UNITS
from sher3_machines.intake.spelling import bare
from sher3_machines.intake.tables import Tables
from sher3_machines.intake.units import UNITS
from sher3_machines.thresholds import FURTHEST

NAMED = "its name says so"
"""Why a place is in a unit that nobody had to guess."""
TOO_FAR = 40.0
"""Position beyond which the unit is hardly rad or m: more than six turns."""
WIDEST_ROOM = 15.0
"""Position beyond which the unit of a sliding axis is hardly m, but mm."""
COARSE = 400.0
"""Position beyond which the unit is hardly degrees either, but counts."""
COARSEST_BITS = 12
"""Bits of a turn that a counting encoder has at least, where nothing says more."""
STEPS = 1e-3
"""Share of the travel below which the smallest step of a signal counts as that of its encoder."""
OUTLYING = 2.0
"""Largest value over what nearly all stay below, from which it is a glitch."""
FEWEST_STEPS = 10
"""Steps from which the smallest one tells an encoder's count."""
FEWEST_LEVELS = 5
"""Steps between levels, of a record of few steps, from which the smallest one does."""
WHOLE, WHOLE_SHARE = 0.05, 0.9
"""How near to a whole multiple of the count a step must be, and the share of steps that must be."""
EPOCH = (9e8, 4e9)
"""Seconds since 1970 of the years 1998 to 2096, which dates are read as."""
DECADE = 3e8
"""Seconds that a record covers at most: a counter may grow through `EPOCH`, and does so from nothing."""
USUAL_RATES = (5.0, 20_000.0)
"""Rates, Hz, between which a clock is believed: of servo loops, and of slow loggers."""
SLOWEST = 1.0
"""Rate, Hz, down to which stamps that are no whole numbers are in s."""
DYING = 0.5
"""Swing of the last third of a record over that of the first one below which its body comes to rest."""
CROSSINGS = 3
"""Times that a body which is let go goes through its place of rest at least: a cooling oven does not."""
CLEAR = 0.2
"""Share of the largest swing that counts as a side."""
GROWING = 0.98
"""Share of the steps of a clock that do not run backwards: logs that were cut together have a few that do."""
EVEN = 0.05
"""Spread of the steps over their mean up to which a column without a telling name is taken for a clock."""
BEGUN_AGAIN = 4
"""Parts of a log, in the mean over its longest one, below which it was begun again."""
LATE, FORWARD = 0.5, 0.95
"""Share of a step by which a clock that pauses may be late, and the share of its steps that are not."""


def clock_of(tables: Tables, guesses: list[str]) -> str:
    """Return the name of the time column: its name says so, and it grows; of several, the column with most samples.

    Raises:
        MachineError: nothing looks like a time.
    """
    growing = {n: x for n, x in tables.items() if x.ndim == 1 and grows(x)}
    clocks = [n for n in growing if tells_time(n)]
    received = [n for n in clocks if bare(n) == "received"]
    clocks = [n for n in clocks if n not in received] or clocks  # the sender's own stamp comes first
    if clocks:
        best = max(clocks, key=lambda n: len(growing[n]))
        guesses.append(f"time is the column {best!r}, because of its name and because it grows")
        return best
    even = [n for n, x in growing.items() if evenly(x) and not counts_samples(n) and parse(bare(n)).signal is None]
    even = [n for n in even if not counts_rows(growing[n])]
    if even:
        guesses.append(f"time is the column {even[0]!r}, because it grows evenly")
        return even[0]
    dated = [n for n, x in growing.items() if EPOCH[0] < x[-1] < EPOCH[1] and np.ptp(x) < DECADE]
    if dated:
        guesses.append(
            f"time is the column {dated[0]!r}, because it grows and reads as a date of today, in s since 1970"
        )
        return dated[0]
    stamps = next((n for n, x in tables.items() if x.ndim == 1 and len(x) and tells_time(n)), None)
    if stamps is not None:
        ends = f"{tables[stamps][0]:.6g} to {tables[stamps][-1]:.6g}"
        remedy = "sort the rows by it, or leave it out and state the rate of the samples, Hz: --rate 500"
        raise MachineError(f"{stamps!r} does not grow", value=ends, limit="stamps that grow", remedy=remedy)
    raise MachineError(
        "no column looks like a time",
        value=", ".join(list(tables)[:12]) or "no column of numbers",
        limit="a growing column named t, time or stamp",
        remedy="name it so (--names t,q,i names all columns in order), or state the rate of the samples, Hz: --rate "
        "500 (`time: {rate: 500}` in a description; a column of a matrix is `time: {column: data, index: 0}`); a "
        "table without a time is of another kind: targets and readings `kind: positioning`, known loads and readings "
        "`kind: load_cell`, wrenches in orientations `kind: force_sensor`, postures with measured poses `kind: arm`; "
        "there is none of a force over speed or travel, and of a sensor of several components in counts",
    )


def comes_to_rest(x: Array) -> bool:
    """Return whether the last third of a record (n,) stays nearer to its end than the first third."""
    swing, third = np.abs(x - x[-1]), len(x) // 3
    return bool(swing[-third:].max() < DYING * swing[:third].max())


def swings_to_rest(x: Array) -> bool:
    """Return whether a column (n,) crosses its last value again and again, and less far at last."""
    off = x - np.median(x[-len(x) // 10 :])
    clear = np.sign(off[np.abs(off) > CLEAR * np.abs(off).max()])
    return int(np.sum(np.diff(clear) != 0.0)) >= CROSSINGS and comes_to_rest(x)


def grows(x: Array) -> bool:
    """Return whether a column (n,) runs forward but for a few steps."""
    known = x[np.isfinite(x)]
    steps, once = np.diff(known), np.diff(_longest_part(known))
    return len(once) > 1 and float(np.mean(steps >= 0.0)) > GROWING and bool(np.median(once.cumsum()) > 0.0)


def _longest_part(x: Array) -> Array:
    """Return the longest part of a column (n,) in which it does not jump back, of a log that was begun again.

    What jumps back more often is an angle that turns.
    """
    longest = max(np.split(x, np.flatnonzero(np.diff(x) < 0.0) + 1), key=len)
    return longest if BEGUN_AGAIN * len(longest) > len(x) else x


def counts_rows(x: Array) -> bool:
    """Return whether a column (n,) grows by one a row, as a number of the sample does."""
    return bool((np.diff(x) == 1.0).all())


def evenly(x: Array) -> bool:
    """Return whether the steps of a column (n,) are even, or are so but for a few pauses and never run back.

    Steps that are read to a coarse tick are even where they are a tick off.
    """
    steps = np.diff(_longest_part(x[np.isfinite(x)]))
    if np.std(steps) < EVEN * np.mean(steps):
        return True
    if not (steps > 0.0).all():
        return False
    tick = float(steps.min()) * (1.0 + WHOLE) if np.median(steps) > steps.min() else 0.0
    return bool(np.mean(np.abs(steps - np.median(steps)) < max(LATE * np.median(steps), tick)) > FORWARD)


def period_of(stamps: Array) -> float:
    """Return the mean step of stamps (n,) that run forward: rounded stamps repeat, so that a median may be zero."""
    steps = np.diff(stamps[np.isfinite(stamps)])
    usual = steps[steps >= 0.0]
    middle = usual[usual <= max(float(np.quantile(usual, 0.95)), 0.0)] if len(usual) else usual
    return float(middle.mean()) if len(middle) and middle.mean() > 0.0 else float("nan")


def period_of_log(time: Mapping[str, Any], tables: Tables) -> float:
    """Return the period of a log, s, by the clock of its draft."""
    stamps = next((x for name, x in tables.items() if time.get("column") in (name, bare(name))), None)
    if stamps is None:
        return 1.0 / (time.get("rate") or 1.0)
    return float(TIME_UNITS[time["unit"]] * np.median(np.diff(stamps)))


def time_unit(clock: str, stamps: Array, guesses: list[str]) -> str:
    """Return the unit of stamps (n,): the unit in the name, else the unit that gives a usual rate."""
    unit = bare_and_unit(bare(clock))[1]
    if unit in TIME_UNITS:
        return str(unit)
    if EPOCH[0] < stamps[-1] < EPOCH[1]:
        guesses.append("time in s since 1970")
        return "s"
    period = period_of(stamps)
    if in_thousandths(stamps):
        guesses.append("time in s, because its stamps are read to a thousandth, which is a ms")
        return "s"
    if SLOWEST < 1.0 / period < USUAL_RATES[0] and bool((stamps % 1.0 != 0.0).mean() > 0.5):
        guesses.append("time in s, because a count of ms or us is whole")
        return "s"
    for unit, scale in TIME_UNITS.items():
        if USUAL_RATES[0] <= 1.0 / (period * scale) <= USUAL_RATES[1]:
            count = "; it grows by one a row, as a number of the sample does: state the rate then, --rate HZ"
            more = count if counts_rows(stamps) else ""
            guesses.append(f"time in {unit}: {1.0 / (period * scale):.4g} samples per second{more}")
            return unit
    guesses.append(f"time in s, though a period of {period:.4g} s is unusual")
    return "s"


def in_thousandths(stamps: Array) -> bool:
    """Return whether stamps (n,) are whole thousandths, of which most are no hundredths."""
    known = 1e3 * stamps[np.isfinite(stamps)]
    fine = np.abs(known / 10.0 - np.round(known / 10.0)) > WHOLE
    return bool((np.abs(known - np.round(known)) < WHOLE * 0.1).all() and fine.mean() > 0.5)


def position_unit(unit: str | None, x: Array, slides: bool = False, reached: float = 0.0) -> tuple[str, float, str]:
    """Return the unit of a position (n,), its factor, and why.

    `slides`: the name of the axis says so. `reached`: the largest value of all positions in the same unit.
    """
    if unit is not None and unit in UNITS and unit not in ("count", "%", "1"):
        return unit, 1.0, NAMED
    largest = reach(x)
    whole, beyond = bool((x == np.round(x)).all()), slides and largest > 1e3 * FURTHEST["linear"]
    if unit == "count" or (whole and largest > COARSE) or beyond:
        bits = max(COARSEST_BITS, int(np.ceil(np.log2(max(float(np.ptp(x)), 2.0)))))
        factor = float(f"{2.0 * np.pi / 2**bits:.6g}")
        why = "its values are whole" if whole or not beyond else f"values reach {largest:.4g}, beyond a room in mm"
        return "count", factor, f"{why}; `factor` is a placeholder: 2^{bits} counts a turn"
    if slides:
        unit = "mm" if largest > WIDEST_ROOM else "m"
        return unit, 1.0, f"its name says that it slides, and values reach {largest:.4g}"
    largest = max(largest, reached)
    if largest > TOO_FAR:
        return "deg", 1.0, f"values reach {largest:.4g}"
    return "rad", 1.0, f"values reach {largest:.4g}; write m for an axis that slides"


def reach(x: Array) -> float:
    """Return the largest absolute value of a signal (n,) but for a few glitches."""
    if not len(x):
        return 0.0
    largest, usual = float(np.abs(x).max()), float(np.quantile(np.abs(x), 0.995))
    return largest if largest < OUTLYING * usual else usual


def travel(x: Array) -> float:
    """Return the span of a signal (n,) but for a few glitches."""
    low, high = np.quantile(x, [0.005, 0.995]) if len(x) else (0.0, 0.0)
    return float(high - low)


def scatter(x: Array) -> float:
    """Return by how much neighbouring samples of a signal (n,) scatter, but between 1e-6 and 1e-4 of its travel.

    A held axis has no travel but its scatter, of which all is then noise.
    """
    if len(x) < FEWEST_STEPS:
        return 0.0
    bend = float(noise_of_bends(np.diff(x, 2)))
    still = 0.1 * travel(x)
    return bend if bend > still else float(np.clip(bend, 1e-6 * travel(x), 1e-4 * travel(x)))


def count_of(x: Array) -> float | None:
    """Return the count of an encoder (n,): the smallest step of its signal, if most steps are whole multiples of it.

    A disc of a few lines takes few steps; the levels that it stood at tell its count then.
    """
    steps = np.abs(np.diff(x))
    steps = steps[steps > 1e-12 * max(1.0, reach(x))]
    if len(steps) < FEWEST_STEPS:
        steps = np.diff(np.unique(x)) if len(x) >= FEWEST_STEPS else steps
    if len(steps) < FEWEST_LEVELS:
        return None
    least = float(np.quantile(steps, 0.01))
    multiples = steps / least
    whole = np.mean(np.abs(multiples - np.round(multiples)) < WHOLE)
    return least if whole > WHOLE_SHARE and least > STEPS * 1e-3 * travel(x) else None
