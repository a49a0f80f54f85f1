"""Two traces of the same commands: how far apart they are, which setting parts them, else which effect."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.report.summary import cause_text
from sher3_effects import every

from sher3_public.answer import Answer
from sher3_public.errors import InputError
from sher3_public.models import source_of
from sher3_public.one_call import diagnose
from sher3_public.records import columns_named, columns_of, is_table, tables_at
from sher3_public.simulators.settings import played, setting_of

TAG = "simulator"
Names = tuple[str, ...]
STAMPS: Names = ("time", "t")
COMMANDS: Names = ("ctrl", "control", "reference", "command")
POSITIONS: Names = ("qpos", "position", "q")
SAME = 1e-6
"""Commands that differ by less than this share of their largest value are the same: tables round their last digit."""


@dataclass(frozen=True)
class Comparison:
    """Where two simulators part.

    Attributes:
        names: of the two.
        apart: rms between their positions, rad or m, for each column.
        settings: of MuJoCo that make each trace, empty where none was found.
        answer: the diagnosis of both, the first as the reference; None where a setting or nothing parts them.
    """

    names: tuple[str, str]
    apart: Array
    settings: tuple[str, str]
    answer: Answer | None

    @property
    def cause(self) -> str:
        """What parts them, in words; empty where nothing does or nothing is known."""
        first, second = self.settings
        if first and second:
            return f"{self.names[0]} has {first}, {self.names[1]} has {second}"
        changes = [] if self.answer is None else [c for c in self.answer.causes if c.condition is not None]
        return "; ".join(cause_text(c) for c in changes)

    def __str__(self) -> str:
        each = ", ".join(f"{x:.3g}" for x in self.apart)
        apart = f"{self.names[1]} against {self.names[0]}: positions differ by {each} (rad or m, rms)"
        return f"{apart}\ncause: {self.cause or self._answer_text()}"

    def _answer_text(self) -> str:
        if not self.apart.any():
            return "none, they are the same"
        return "none found" if self.answer is None else self.answer.headline


def compare_simulators(
    first: Any, second: Any, model: object = None, names: tuple[str, str] = ("first", "second")
) -> Comparison:
    """Say where two simulators differ that were given the same commands, and why.

    Args:
        first: table of the reference: `time` (n,), s; `ctrl` (or `reference`) and `qpos` (or `position`), (n, k); what
            `diagnose` takes besides, as `effort`; or the path of such a log.
        second: table of the other one, on the same stamps.
        model: of the robot, as `diagnose` takes it. With MJCF, settings of MuJoCo are tried first: integrator, friction
            cone, time step. None: axes by themselves.
        names: of the two, for the answer.

    Raises:
        InputError: the tables have not the same stamps or not the same commands, or no positions.
        MachineError: as `diagnose` does.
    """
    tables = _trace(first), _trace(second)
    apart = _apart(*tables)
    found = _settings(model, *tables) if apart.any() else ("", "")
    if all(found) or not apart.any():
        return Comparison(names, apart, found, None)
    impossible = {page.id for page in every().values() if page.of_recorder}
    return Comparison(names, apart, ("", ""), diagnose(model, list(tables), tags={TAG: names}, without=impossible))


def _trace(given: Any) -> dict[str, Array]:
    """Return the columns of a table, or of the log at a path, numbered ones as one; raises InputError for all else."""
    found = tables_at(given) if isinstance(given, PathLike) or (isinstance(given, str) and "<" not in given) else given
    found = found[0] if isinstance(found, list) and len(found) == 1 else found
    if not is_table(found):
        remedy = "give a table, or a log of one run, for each: compare_simulators(first, second, model)"
        raise InputError("a trace is no table", value=type(given).__name__, remedy=remedy)
    columns = columns_of(found)
    whole = {n: x for n in (*COMMANDS, *POSITIONS) if (x := columns_named(columns, [n])) is not None}
    return whole | {n: x for n, x in columns.items() if n.rstrip("0123456789]").rstrip("_.[") not in whole}


def _apart(first: Mapping[str, Array], second: Mapping[str, Array]) -> Array:
    """Return the rms between the positions; raises InputError where the traces are not of the same commands."""
    for what, names in (("stamps", STAMPS), ("commands", COMMANDS), ("positions", POSITIONS)):
        each = [columns_named(table, names) for table in (first, second)]
        lacking = [i for i, x in enumerate(each) if x is None]
        if lacking and (what != "commands" or len(lacking) == 1):
            value, limit = ", ".join((first, second)[lacking[0]]), ", ".join(names)
            missing = f"{what} are missing in the {('first', 'second')[lacking[0]]} trace"
            raise InputError(missing, value=value, limit=limit, remedy="name the columns so")
        a, b = (np.empty((0, 0)) if x is None else x for x in each)
        if a.shape != b.shape:
            remedy = "record both at the same stamps, as many columns of each; cut the longer one"
            raise InputError(f"{what} differ in rows and columns", value=b.shape, limit=a.shape, remedy=remedy)
        away = float(np.abs(a - b).max(initial=0.0))
        if what != "positions" and away > SAME * np.abs(a).max(initial=0.0):
            raise InputError(f"{what} differ", value=away, remedy="give both simulators the same, open loop")
    one, other = columns_named(first, POSITIONS), columns_named(second, POSITIONS)
    assert one is not None and other is not None
    return np.sqrt(np.mean((one - other) ** 2, axis=0))


def _settings(model: object, first: Mapping[str, Array], second: Mapping[str, Array]) -> tuple[str, str]:
    mujoco = None if model is None else source_of(model).bodies.mujoco
    if mujoco is None:
        return "", ""
    one, other = played(mujoco, first), played(mujoco, second)
    return ("", "") if one is None or other is None else setting_of(mujoco, one, other)
