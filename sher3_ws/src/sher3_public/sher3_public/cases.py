"""A machine with its runs, in memory: from arrays and a model, from a table with names, or from a description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.draft import arm_description
from sher3_chain.manipulator.kind import arm_of
from sher3_diagnosis.machine import Machine
from sher3_machines.drafting.draft import drafted
from sher3_machines.drafting.guesses import period_of_log
from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Description
from sher3_machines.intake.kinds import kinds, load_description
from sher3_machines.intake.tables import Tables

from sher3_public.arrays import of_tables
from sher3_public.arrays.describing import described
from sher3_public.arrays.stating import Stated
from sher3_public.errors import InputError
from sher3_public.models import Source, source_of
from sher3_public.records import Arrays, per_run

RECORD = Path("table")
"""What a table is called where a file's name would stand."""


@dataclass(frozen=True)
class Case:
    """What is diagnosed.

    Attributes:
        machine: with its description.
        runs: on a uniform clock, SI units.
        source: the model that was given; None: none was.
        guesses: what was taken for what, one sentence each.
        notes: what was done to the data.
    """

    machine: Machine[Any, Any]
    runs: Sequence[Any]
    source: Source | None
    guesses: Sequence[str] = ()
    notes: Sequence[str] = field(default_factory=tuple)


def case_of_arrays(model: object, arrays: Sequence[Arrays], stated: Stated, tags: Any) -> Case:
    """Return an arm of a model with its runs, arrays (n, k); raises InputError and MachineError as `diagnose` does."""
    source = source_of(model)
    found = described(source, arrays, stated)
    return _case(found.data, found.tables, source, found.guesses, tags)


def case_of_tables(model: object, tables: Sequence[Tables], rate: float | None, stated: Stated, tags: Any) -> Case:
    """Return an arm, or axes by themselves without a model, whose columns have telling names; raises as above."""
    guesses: list[str] = []
    of_tables.check_names(stated)
    if stated.units:
        tables = of_tables.in_si(tables, drafted(RECORD, tables[0], rate, []), stated)
    data = drafted(RECORD, tables[0], rate, guesses)
    source = None if model is None else source_of(model)
    if source is None and stated.inertias != "nominal":
        raise InputError("inertias are those of an arm's model", value="no model", remedy="give the arm's MJCF or URDF")
    if source is not None:
        drives = of_tables.drives_of(source.bodies, tables[0], data, stated)
        period = period_of_log(data["time"], tables[0])
        data = arm_description(data, source.bodies, guesses, drives, stated.simulated, period)
        source = source if data["kind"] == "manipulator" else None  # no model belongs to servos by themselves
    if source is not None:
        data["inertias"] = stated.inertias
    of_tables.apply_stated(data["axes" if source is None else "joints"], stated, guesses)
    return _case(data, tables, source, guesses, tags)


def case_of_description(model: Any, tables: Sequence[Tables], tags: Any) -> Case:
    """Return a machine of any kind by its description; raises as above."""
    if not isinstance(model, Mapping | Description):
        model = load_description(Path(model))
    data = dict(model) if isinstance(model, Mapping) else model.model_dump(exclude_unset=True)
    return _case(data, tables, source_of(data["model"]) if data.get("kind") == "manipulator" else None, [], tags)


def _case(data: dict[str, Any], tables: Sequence[Tables], source: Source | None, guesses: list[str], tags: Any) -> Case:
    names = [f"run{i + 1}" for i in range(len(tables))] if len(tables) > 1 else ["run"]
    conditions = dict(zip(names, per_run(tags, len(tables)), strict=False))
    data = {**data, **({"conditions": conditions} if conditions else {})}
    kind = kinds().get(str(data.get("kind")))
    if kind is None:
        raise InputError.unknown("no such kind of machine", data.get("kind"), kinds())
    try:
        description = kind.description.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the description"
        value = str(first["input"])[:60]
        raise MachineError(f"{place}: {first['msg']}", value=value, remedy="correct what was stated") from error
    runs = []
    records, few = kind.chosen(dict(zip(names, tables, strict=True)), description)
    notes = [few] if few else []
    for name, table in records.items():
        parts, note = kind.parts(name, table, description, len(records))
        notes += [note] if note else []
        runs += [kind.read(part, x, description) for part, x in parts.items()]
    if source is not None and isinstance(description, ManipulatorDescription):
        machine: Machine[Any, Any] = arm_of(description, source.bodies)
    else:
        machine = kind.machine(description)
    return Case(machine, runs, source, guesses, notes)
