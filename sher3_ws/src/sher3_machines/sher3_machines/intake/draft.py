"""A description drafted from a file: what each column seems to be, and everything that was guessed."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from sher3_common import dump_yaml
from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError
from sher3_machines.intake.columns import IN_HEADER, SPELLINGS
from sher3_machines.intake.fields import UNITS
from sher3_machines.intake.tables import Tables, read_tables

CLOCKS = ("stamp", "time", "timestamp", "timestamps", "t", "zeit", "date", "datetime", "received")
"""Names of a time column, best first."""
SIGNALS = {
    "reference": r"ref|reference|setpoint|set_point|desired|des|target|goal|soll|qg|q_?d",
    "load": r"load|second|output|scale|link|tip_encoder",
    "effort": r"effort|torque|tau|force|current|curr|i|iq|trq|moment",
    "command": r"command|cmd|u|voltage|volt|pwm|vir",
    "velocity": r"velocity|vel|speed|qd|dq|omega|qdot",
    "position": r"positions?|pos|q|theta|angle|encoder|enc|ist|actual|measured|qm|x",
}
"""Signal -> words of a column's name that speak for it; the first one that fits counts."""
ROTARY_UNITS = ("rad", "mrad", "deg", "rev")
TOO_FAR = 40.0
"""Position beyond which the unit is hardly rad or m: more than six turns."""
COARSE = 400.0
"""Position beyond which the unit is hardly degrees either, but counts."""
STEPS = 1e-3
"""Share of the travel below which the smallest step of a signal counts as that of its encoder."""
WIDEST = 12
"""Entries of an array column that may be axes: a humanoid's arms; wider ones are matrices."""
FEWEST_STEPS = 10
"""Steps from which the smallest one tells an encoder's count."""
WHOLE, WHOLE_SHARE = 0.05, 0.9
"""How near to a whole multiple of the count a step must be, and the share of steps that must be."""
TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
USUAL_RATES = (5.0, 20_000.0)
"""Rates, Hz, between which a clock is believed: of servo loops, and of slow loggers."""


@dataclass
class Draft:
    """A description as YAML, and the guesses it rests on, one sentence each."""

    text: str
    guesses: list[str] = field(default_factory=list)


def draft(path: Path) -> Draft:
    """Draft a description of a chain of axes from a data file, folder or bag.

    Raises:
        MachineError: the file cannot be read, or no column looks like a position.
    """
    tables = read_tables(path)
    guesses: list[str] = []
    clock, time = _clock(tables, guesses)
    groups: dict[str, dict[str, Any]] = {}
    for name, x in tables.items():
        if len(x) == len(time) and name != clock and not name.endswith(CLOCKS[-1]):
            for index in range(x.shape[1]) if x.ndim == 2 and x.shape[1] <= WIDEST else [None]:
                _place(name, index, groups)
    axes = [_axis(axis, signals, tables, guesses) for axis, signals in groups.items() if "position" in signals]
    if not axes:
        raise MachineError(
            f"{path}: no column looks like a position",
            value=", ".join(sorted(tables)[:12]),
            limit="names with position, pos, q, angle, encoder",
            remedy="write the description by hand",
        )
    period = float(np.median(np.diff(time)))
    unit = _time_unit(clock, period, guesses)
    column = clock.rsplit("/", 1)[-1] if "/" in clock else clock
    stem = re.sub(r"\W+", "_", path.stem)
    data = {"kind": "axes", "name": stem, "time": {"column": column, "unit": unit}, "axes": axes}
    head = "".join(f"# guessed: {guess}\n" for guess in guesses)
    return Draft(head + dump_yaml(data), guesses)


def _clock(tables: Tables, guesses: list[str]) -> tuple[str, Array]:
    """Return the time column: of a known name, growing; the one with most samples."""
    rising = {n: x for n, x in tables.items() if x.ndim == 1 and len(x) > 2 and bool((np.diff(x) > 0.0).all())}
    for word in CLOCKS:
        named = [
            n for n in rising if _bare(n).lower() == word or re.fullmatch(rf"{word}[_ ]?\w{{0,4}}", _bare(n).lower())
        ]
        if named:
            best = max(named, key=lambda n: len(rising[n]))
            guesses.append(f"time is the column {best!r}, because of its name and because it only grows")
            return best, rising[best]
    raise MachineError(
        "no column looks like a time",
        value=", ".join(sorted(tables)[:12]),
        limit="a growing column named t, time or stamp",
        remedy="name it so, or state `time: {rate: HZ}` by hand",
    )


def _bare(name: str) -> str:
    """Return a column's name without its table and unit."""
    match = IN_HEADER.fullmatch(name)
    return (match["name"] if match else name).rsplit("/", 1)[-1]


def _place(name: str, index: int | None, groups: dict[str, dict[str, Any]]) -> None:
    """Put a column down as a signal of an axis, where its name says one."""
    bare = _bare(name)
    for signal, pattern in SIGNALS.items():
        word = re.search(rf"(?:^|[_.\s\-/]|(?<=[a-z])(?=[A-Z]))({pattern})(?:$|[_.\s\-/\d])", bare, re.I)
        if word:
            rest = (bare[: word.start(1)] + bare[word.end(1) :]).strip("_.- ")
            table = name.rsplit("/", 1)[0].rsplit("/", 1)[-1] if "/" in name else ""
            axis = "_".join(x for x in (rest or table or "axis", "" if index is None else str(index + 1)) if x)
            groups.setdefault(re.sub(r"\W+", "_", axis), {}).setdefault(signal, (name, index))
            return


def _axis(axis: str, signals: dict[str, tuple[str, int | None]], tables: Tables, guesses: list[str]) -> dict[str, Any]:
    name, index = signals["position"]
    x = tables[name] if index is None else tables[name][:, index]
    unit, why = _position_unit(name, x)
    guesses.append(f"{axis}: position in {unit}, because {why}")
    count = _count(x)
    factor = 1.0 if unit == "count" else UNITS[unit]
    resolution = (count or float(np.ptp(x)) * 1e-6 or 1e-6) * factor
    said = "its smallest step" if count else "a millionth of its travel: no step is seen"
    guesses.append(f"{axis}: encoder_resolution {resolution:.3g}, {said}")
    columns: dict[str, Any] = {}
    for signal in ("position", "reference", "command", "effort", "load"):
        if signal in signals:
            columns[signal] = _column(*signals[signal], unit if signal in ("position", "reference", "load") else None)
            if signal != "position":
                guesses.append(f"{axis}: {signal} is {signals[signal][0]!r}, because of its name")
    law = _law(axis, columns, guesses)
    motion = "rotary" if unit in ROTARY_UNITS or unit == "count" else "linear"
    out = {"name": axis, "motion": motion, "signals": columns, "command_law": law}
    if law["kind"] == "force":
        guesses.append(f"{axis}: mass is not known and will be identified from the record; state it where you can")
        out["mass"] = "unknown"
    return {**out, "encoder_resolution": float(f"{resolution:.6g}")}


def _column(name: str, index: int | None, unit: str | None) -> dict[str, Any]:
    found: dict[str, Any] = {"column": name, "unit": unit or _header_unit(name) or "1"}
    if index is not None:
        found["index"] = index
    if found["unit"] == "count":
        found["factor"] = 0.001
    return found


def _law(axis: str, columns: dict[str, Any], guesses: list[str]) -> dict[str, Any]:
    if "effort" in columns or "command" in columns:
        guesses.append(
            f"{axis}: driven by a force; its effort and command count as N or N m until `factor` and `gain` say more"
        )
        return {"kind": "force"}
    if "reference" in columns:
        guesses.append(f"{axis}: a position servo, because a reference and no force was recorded")
        return {"kind": "position"}
    guesses.append(f"{axis}: undriven, because neither reference nor force was found")
    return {"kind": "none"}


def _header_unit(name: str) -> str | None:
    match = IN_HEADER.fullmatch(name)
    said = SPELLINGS.get(match["unit"].strip(), match["unit"].strip()) if match else None
    ending = name.rsplit("_", 1)[-1]
    return said if said in UNITS else ending if ending in UNITS and ending not in ("1", "s") else None


def _position_unit(name: str, x: Array) -> tuple[str, str]:
    if unit := _header_unit(name):
        return unit, "its name says so"
    largest = float(np.nanmax(np.abs(x)))
    if bool((x == np.round(x)).all()) and largest > COARSE:
        return "count", f"all values are whole and reach {largest:.4g}; `factor` is a placeholder"
    if largest > TOO_FAR:
        return "deg", f"values reach {largest:.4g}"
    return "rad", f"values reach {largest:.4g}; write m for an axis that slides"


def _count(x: Array) -> float | None:
    """Return the smallest step of a signal where it is one of an encoder: most steps are whole multiples of it."""
    steps = np.abs(np.diff(x))
    steps = steps[steps > 1e-12 * max(1.0, float(np.abs(x).max()))]
    if len(steps) < FEWEST_STEPS:
        return None
    least = float(np.quantile(steps, 0.01))
    multiples = steps / least
    whole = np.mean(np.abs(multiples - np.round(multiples)) < WHOLE)
    return least if whole > WHOLE_SHARE and least > STEPS * 1e-3 * float(np.ptp(x)) else None


def _time_unit(clock: str, period: float, guesses: list[str]) -> str:
    """Return the unit of the stamps: of the header, or the one that makes the rate usual."""
    unit = _header_unit(clock)
    if unit in TIME_UNITS:
        return str(unit)
    for unit, scale in TIME_UNITS.items():
        if USUAL_RATES[0] <= 1.0 / (period * scale) <= USUAL_RATES[1]:
            guesses.append(f"time in {unit}: {1.0 / (period * scale):.4g} samples per second")
            return unit
    guesses.append(f"time in s, though a period of {period:.4g} s is unusual")
    return "s"
