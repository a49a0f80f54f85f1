"""Which signal of which axis each column is: of one by its name, of several by what stands beside them."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_machines.drafting.guesses import evenly, grows, travel
from sher3_machines.drafting.names import (
    APPLIED,
    ASKED_SPEED,
    DIRECTIONS,
    DRIVING,
    FORCES,
    HELD,
    IGNORED,
    MODELLED,
    PARTS,
    PLACES,
    POSITION,
    SECOND,
    TURNING,
    TWOFOLD,
    counts_samples,
    parse,
    words_of,
)
from sher3_machines.drafting.strangers import without_strangers
from sher3_machines.intake.spelling import bare, table_of
from sher3_machines.intake.tables import SAMPLES, Tables

SIGNALS = ("position", "reference", "command", "effort", "load", "applied", "temperature", "velocity")
"""Signals of an axis that a draft looks for, in the order they are written."""
WIDEST = 12
"""Entries of an array column that may be axes: a humanoid's arms; wider ones are matrices."""
DEMANDED = {"command", "commanded", "cmd", "action"}
"""Words for what a drive is told, whether a place or a force."""
ASKED_FOR = ("reference", ASKED_SPEED)
"""Signals that may stay as they are all along, and then say that a place is held."""
TOLD = (*ASKED_FOR, "command", "effort")
"""Signals that a log may have a reading of where they change alone."""
LAST_NUMBER = re.compile(r"(?P<stem>.*?)(?P<number>\d+)")
"""Name of an axis that ends in a number."""
NEAR = 0.1
"""Share of the travel that a place stays behind what was asked of it, at most: a torque is further from it."""
OF_INPUT = re.compile(r"(?<![A-Za-z])u(?![A-Za-z])")
"""The letter of what drives, in whose place `y` stands for what comes out: `u_train`, `y_train`."""
ALONG_X = re.compile(r"(?<![A-Za-z])[xX](?![A-Za-z])")
"""The letter of a place beside one along `y`: `tip_x`, `tip_y`."""
EVERY = "*"
"""Axis of a signal that all axes share: one speed is asked of both wheels."""

Place = tuple[str, int | None]
"""A column, and the entry of it where each sample is a list."""


def placed(tables: Tables, clock: str | None, guesses: list[str], held: bool = False) -> dict[Place, tuple[str, str]]:
    """Return signal and axis of every column whose name, or what stands beside it, says one.

    Args:
        tables: of the file.
        clock: column of the time; None: there is none.
        guesses: so far.
        held: whether a place that never changes counts: a joint that is held still carries the others.
    """
    living = _living(counted_alike(_with_targets(_roles_by_name(tables, clock), tables)), tables, guesses, held)
    return with_loads(with_speeds(with_drive(with_output(living, tables))))


def counted_alike(placed: Mapping[Place, tuple[str, str]]) -> dict[Place, tuple[str, str]]:
    """Return the signals with families of columns that count from the same number: `tau1` goes with `q0`.

    A family is what differs in its last number alone, `q0` to `q5`. One of as many members in a row as the positions
    have, but from another number on, is counted as these are: of two zeros that people count from, both are meant.
    """
    families: dict[tuple[str, str], dict[int, Place]] = {}
    for place, (signal, axis) in placed.items():
        if match := LAST_NUMBER.fullmatch(axis):
            families.setdefault((signal, match["stem"]), {})[int(match["number"])] = place
    rows = {key: family for key, family in families.items() if max(family) - min(family) == len(family) - 1 > 0}
    bases = {stem: family for (signal, stem), family in rows.items() if signal == "position"}
    out = dict(placed)
    for (signal, stem), family in rows.items():
        base = bases.get(stem, next(iter(bases.values())) if len(bases) == 1 else {})
        if len(base) == len(family) and min(base) != min(family):
            shift = min(base) - min(family)
            out |= {place: (signal, f"{stem}{number + shift}") for number, place in family.items()}
    return out


def _roles_by_name(tables: Tables, clock: str | None) -> dict[Place, tuple[str, str]]:
    """Return signal and axis of every column whose name says one, of tables that have stamps.

    What has the name of the clock and never goes back is the clock of its own table.
    """
    lengths = {table_of(n): len(x) for n, x in tables.items() if clock and bare(n) == bare(clock)}
    least = len(tables[clock]) if clock else 0
    found: dict[Place, tuple[str, str]] = {}
    for name, x in tables.items():
        stamped = len(x) == lengths.get(table_of(name), least) or not clock
        what = parse(name)
        timed = clock is not None and bare(name) == bare(clock) and not (np.diff(x, axis=0) < 0.0).any()
        if what.signal is None or not stamped or timed or counts_samples(name):
            continue
        for index in range(x.shape[1]) if x.ndim == 2 and x.shape[1] <= WIDEST else [None]:
            if x.ndim == 1 or index is not None:
                axis = "_".join(w for w in (what.axis, "" if index is None else str(index + 1)) if w)
                found[name, index] = what.signal, axis
    found = without_strangers(found, tables, clock)
    return _without_vague(found | _beside(found, tables), tables)


def _without_vague(found: Mapping[Place, tuple[str, str]], tables: Tables) -> dict[Place, tuple[str, str]]:
    """Return the signals; of places that no word calls so, those that are no speed once more.

    One that is measured alone goes too where it is an even grid, or where another one is called a place.
    """
    vague = {p: signal for p, (signal, _) in found.items() if signal in ("position", "load") and not _says_place(p[0])}
    clear = any(signal == "position" and p not in vague for p, (signal, _) in found.items())
    speeds = [values_of(p, tables) for p, (signal, _) in found.items() if signal == "velocity"]

    def stays(p: Place) -> bool:
        x = values_of(p, tables)
        again = any(np.array_equal(x, v) for v in speeds)
        return not again and (vague[p] == "load" or not (clear or (grows(x) and evenly(x))))

    return {p: what for p, what in found.items() if p not in vague or stays(p)}


def _beside(found: Mapping[Place, tuple[str, str]], tables: Tables) -> dict[Place, tuple[str, str]]:
    """Return places along x with those along y, and z, beside them, where no `u` drives what comes out as `y`."""
    out: dict[Place, tuple[str, str]] = {}
    for (name, index), (signal, axis) in found.items():
        others = {d: ALONG_X.sub(lambda match, k=k: chr(ord(match[0]) + k), name) for k, d in enumerate("xyz")}
        along = {n: d for d, n in others.items() if n in tables and tables[n].shape == tables[name].shape}
        if signal == "position" and {"x", "y"} <= set(along.values()):
            rest = [w for w in axis.split("_") if w and w != "x"]
            out |= {(n, index): (signal, "_".join([*rest, d])) for n, d in along.items()}
    driven = any(OF_INPUT.search(bare(name)) for name in tables)
    return {} if driven else out


def _with_targets(found: Mapping[Place, tuple[str, str]], tables: Tables) -> dict[Place, tuple[str, str]]:
    """Return the signals with what may be an effort, or a place, as the place that its axis lacks where it is near."""
    signals, out = {what: values_of(p, tables) for p, what in found.items()}, dict(found)
    efforts = [(p, a) for p, (signal, a) in found.items() if signal == "effort" and parse(p[0]).unit not in FORCES]
    unsure = [(p, axis, *TWOFOLD[word]) for p, axis in efforts for word in words_of(p[0]) if word in TWOFOLD]
    for p, axis, lacked, beside in unsure:
        x, y = signals.get((beside, axis), np.zeros(0)), values_of(p, tables)
        near = 0 < len(x) == len(y) and float(np.sqrt(np.mean((x - y) ** 2))) < NEAR * travel(x)
        if near and (lacked, axis) not in signals:
            out[p] = lacked, axis
    return out


def _says_place(name: str) -> bool:
    """Return whether a name speaks of a place, by a word or a unit, and not of something that was measured alone."""
    return bool(set(words_of(name)) & ((POSITION | TURNING) - DIRECTIONS)) or parse(name).unit is not None


def _living(
    placed: Mapping[Place, tuple[str, str]], tables: Tables, guesses: list[str], held: bool
) -> dict[Place, tuple[str, str]]:
    """Return the signals without what was not connected: a reading that never changes, beside places that do.

    What an axis is asked for may stay, where nothing else drives it; a column without a number is none.
    """
    found = {p: (signal, values_of(p, tables)) for p, (signal, _) in placed.items()}
    driven = any(signal in ("command", "effort") and moves(x) for signal, x in found.values())
    stays = (*(() if driven else ASKED_FOR), *(("position",) if held else ()))
    told = {p for p, (signal, x) in found.items() if signal in TOLD and len(np.unique(x)) > 1}  # posted as it changes
    dead = [p for p, (signal, x) in found.items() if not (moves(x) or p in told or (signal in stays and len(x)))]
    alive = {p: what for p, what in placed.items() if p not in dead}
    if not any(signal in ("position", "load", "velocity") for signal, _ in alive.values()):
        return dict(placed)
    if dead:
        guesses.append(f"never changes, and is not used: {', '.join(dict.fromkeys(name for name, _ in dead))}")
    return alive


def with_output(placed: Mapping[Place, tuple[str, str]], tables: Tables) -> dict[Place, tuple[str, str]]:
    """Return the signals with a position, or a command, where no name says one.

    A controller beside its set-point reads `Input` and puts out `Output`, or `out`. A position is a column `y`, where
    another column drives, `u`, or `y_train` beside `u_train`; else every column in a unit of a place.
    """
    signals = {signal for signal, _ in placed.values()}
    plain = {bare(name).lower(): (name, None) for name, x in tables.items() if x.ndim == 1 and moves(x)}
    asked, read = signals & set(ASKED_FOR), signals & {"position", "velocity"}
    if asked and not read and {"input", "output"} <= plain.keys():
        return {**placed, plain["input"]: ("position", ""), plain["output"]: ("command", "")}
    if read or "load" in signals:
        drives = asked and "out" in plain and not signals & {"command", "effort"}
        return {**placed, plain["out"]: ("command", "")} if drives else dict(placed)
    if "command" in signals and "y" in tables:
        return {**placed, ("y", None): ("position", "")}
    pairs = {
        (OF_INPUT.sub("y", name), index): (name, axis)
        for (name, index), (signal, axis) in placed.items()
        if signal == "command" and OF_INPUT.search(bare(name))
    }
    if pairs and all(n in tables and tables[n].shape == tables[drive].shape for (n, _), (drive, _) in pairs.items()):
        return {**placed, **{p: ("position", axis) for p, (_, axis) in pairs.items()}}
    unsaid = [name for name, x in tables.items() if x.ndim == 1 and (name, None) not in placed and moves(x)]
    others = {name: parse(name) for name in unsaid if not set(words_of(bare(name))) & IGNORED}
    places = [n for n, w in others.items() if w.unit in PLACES]
    places = places or [n for n, w in others.items() if w.unit is None and _is_part(n)]
    return {**placed, **{(n, None): ("position", others[n].axis or bare(n)) for n in places}}


def _is_part(name: str) -> bool:
    """Return whether a name is a part of a machine and its number, and says nothing else."""
    words = words_of(bare(name))
    return bool(set(words) & PARTS) and all(word in PARTS or word.isdigit() for word in words)


def with_drive(placed: Mapping[Place, tuple[str, str]]) -> dict[Place, tuple[str, str]]:
    """Return the signals with a torque that is called applied as that of the drive, where it was told a torque.

    Where an effort was measured, or where the word stands beside one for a load, the torque comes from outside.
    """
    names = {p: (signal, set(words_of(bare(p[0])))) for p, (signal, _) in placed.items()}
    by_torque = any(signal == "command" and parse(p[0]).unit in FORCES for p, (signal, _) in names.items())
    if not by_torque or any(signal == "effort" and not words & MODELLED for signal, words in names.values()):
        return dict(placed)
    own = [p for p, (signal, words) in names.items() if signal == "applied" and words & APPLIED == {"applied"}]
    kept = {p: what for p, what in placed.items() if not own or what[0] != "effort"}
    return kept | {p: ("effort", kept[p][1]) for p in own}


def with_speeds(placed: Mapping[Place, tuple[str, str]]) -> dict[Place, tuple[str, str]]:
    """Return the signals with velocities as places, where no place was recorded at all: they are integrated.

    A speed that is asked for is then the reference; any other demand is what the drive is told.
    """
    if any(signal in ("position", "load") for signal, _ in placed.values()):
        return dict(placed)
    several = len({axis for signal, axis in placed.values() if signal == "velocity"}) > 1
    asked = any(signal == ASKED_SPEED for signal, _ in placed.values())
    out = {}
    for p, (signal, axis) in placed.items():
        if signal == "velocity":
            out[p] = "position", axis
        elif signal == ASKED_SPEED:
            out[p] = "reference", axis or (EVERY if several else "")
        else:
            demanded = asked and signal == "reference" and set(words_of(bare(p[0]))) & DEMANDED
            out[p] = "command" if demanded else signal, axis
    return out


def with_loads(placed: Mapping[Place, tuple[str, str]]) -> dict[Place, tuple[str, str]]:
    """Return the signals in which the position of an axis that no drive moves is its `load`, beside the driven ones.

    Where trackers and scales alone were recorded, what they read stays a position; a load alone is a force.
    """
    out = dict(placed)
    if all(signal != "position" for signal, _ in placed.values()):
        alone = {p: set(words_of(bare(p[0]))) & (POSITION | SECOND - HELD) or parse(p[0]).unit for p in placed}
        kept = {p: what for p, what in placed.items() if what[0] != "load" or alone[p]}
        return {p: ("position" if signal == "load" else signal, axis) for p, (signal, axis) in kept.items()}
    for axis in {axis for _, axis in placed.values()}:
        places = [p for p, found in placed.items() if found == ("position", axis)]
        driven = [p for p in places if set(words_of(bare(p[0]))) & DRIVING]
        others = [p for p in places if p not in driven]
        if driven and len(others) == 1 and ("load", axis) not in placed.values():
            out[others[0]] = "load", axis
    return out


def moves(x: Array) -> bool:
    """Return whether a column (n,), or a matrix (n, k), of `SAMPLES` rows or more holds more than one value."""
    return x.ndim in (1, 2) and len(x) >= SAMPLES and float(np.ptp(x)) > 0.0


def values_of(place: Place, tables: Tables) -> Array:
    """Return the numbers (n,) of a column or of an entry of it, without those that are not finite."""
    x = tables[place[0]] if place[1] is None else tables[place[0]][:, place[1]]
    return np.asarray(x[np.isfinite(x)])
