"""Recorded speeds in a draft: they tell a wrong unit of the clock, and what does not agree with them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.drafting.names import parse
from sher3_machines.intake.fields import TIME_UNITS, VELOCITIES
from sher3_machines.intake.mending.counted import counted_stamps
from sher3_machines.intake.mending.fields import signed
from sher3_machines.intake.mending.motion import AGREES, likely_unit, speed_ratio
from sher3_machines.intake.tables import SAMPLES, Tables
from sher3_machines.intake.units import UNITS


def checked_by_speed(
    time: dict[str, Any], axes: list[dict[str, Any]], tables: Tables, stamps: Array | None, guesses: list[str]
) -> None:
    """Hold recorded speeds (n,) against positions: they tell a wrong unit of the clock, else they are left out."""
    ratios: dict[str, float | None] = {}
    for axis in axes:
        if (column := axis["signals"].get("velocity")) is not None:
            ratios[axis["name"]] = _ratio(axis["signals"]["position"], column, time, tables, stamps)
    for axis in axes:
        counts = ratios.get(axis["name"]) or 0.0
        if counts > 0.0 and _counted(axis["signals"]):
            _count_by_speed(axis, counts, guesses)
            ratios[axis["name"]] = 1.0
    units = {likely_unit(r, time.get("unit")) if r is not None else None for r in ratios.values()}
    if len(units) == 1 and (unit := units.pop()) is not None and unit != time["unit"]:
        guesses.append(f"time in {unit} and not in {time['unit']}, because the recorded speed says so")
        ratios = {name: ratio * TIME_UNITS[time["unit"]] / TIME_UNITS[unit] for name, ratio in ratios.items() if ratio}
        time.update({"unit": unit, "override": True})
    for axis in axes:
        ratio = ratios.get(axis["name"])
        if ratio is not None and abs(ratio - 1.0) < AGREES:
            guesses.append(f"{axis['name']}: velocity is {axis['signals']['velocity']['column']!r}; the clock agrees")
        elif axis["signals"].pop("velocity", None) is not None:
            said = f": the position moves {ratio:.3g} times as far" if ratio else ""
            guesses.append(f"{axis['name']}: its recorded velocity is not used, because it does not agree{said}")


def _counted(signals: Mapping[str, Any]) -> bool:
    """Return whether a place is in counts of a turn that nobody knows, beside a speed whose name has its unit."""
    stated = parse(signals["velocity"]["column"]).unit in VELOCITIES
    return signals["position"]["unit"] == "count" and stated and "load" not in signals


def _count_by_speed(axis: dict[str, Any], ratio: float, guesses: list[str]) -> None:
    """Take the count of a place from a recorded speed, of which the place moves `ratio` times the integral."""
    signals = axis["signals"]
    for signal in ("position", "reference"):
        if signal in signals and signals[signal]["unit"] == "count":
            signals[signal]["factor"] = float(f"{signals[signal]['factor'] / ratio:.6g}")
    guesses.append(
        f"{axis['name']}: `factor` of a count {signals['position']['factor']:.6g}: the recorded speed says so"
    )


def _ratio(
    position: Mapping[str, Any], velocity: Mapping[str, Any], time: Mapping[str, Any], tables: Tables, t: Array | None
) -> float | None:
    """Return how far a drafted position moves over the integral of a drafted velocity; None where that says nothing."""
    x, v = (_numbers(column, tables) for column in (position, velocity))
    t = np.arange(len(x)) / time["rate"] if t is None else t * TIME_UNITS[time["unit"]]
    if not len(t) == len(x) == len(v):
        return None
    kept = np.isfinite(t) & np.isfinite(x) & np.isfinite(v)
    kept[kept] = np.concatenate([[True], np.diff(t[kept]) > 0.0])
    if kept.sum() <= SAMPLES:
        return None
    t, x, v = t[kept], x[kept], v[kept]
    counted = counted_stamps(t, x[:, None], v[:, None])  # what the import takes for the clock
    return speed_ratio(t if counted is None else counted, x, v)


def _numbers(column: Mapping[str, Any], tables: Tables) -> Array:
    """Return the samples of a drafted column in SI units."""
    x = tables[column["column"]]
    x, _ = signed(x if "index" not in column else x[:, column["index"]])
    return np.asarray(x * UNITS[column["unit"]] * column.get("factor", 1.0))
