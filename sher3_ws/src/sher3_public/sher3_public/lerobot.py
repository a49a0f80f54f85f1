"""LeRobot data sets in one call: commands of the joints against their motion."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from sher3_effects import computed
from sher3_machines.drafting.guesses import reach
from sher3_machines.intake.readers.lerobot import DataSet, read_data_set
from sher3_machines.intake.units import UNITS

from sher3_public.answer import Answer
from sher3_public.arrays.stating import Stated
from sher3_public.cases import case_of_arrays, case_of_tables
from sher3_public.errors import InputError
from sher3_public.missed import SHARE, with_missed
from sher3_public.models import source_of
from sher3_public.records import Array, Arrays

STATE, ACTION = "observation.state/", "action/"
CLOCK = "timestamp"
ANGLES = ("rad", "deg")
MOST_TURNS = 2.0
"""Turns beyond which states are no radians."""


def from_lerobot(
    path: str | Path,
    model: object = None,
    *,
    unit: str | None = None,
    episodes: Collection[int] = (),
    joints: Sequence[str] = (),
    tags: Mapping[str, Sequence[object]] | Sequence[Mapping[str, object]] | None = None,
    without: Collection[str] = (),
) -> Answer:
    """Diagnose the joints of a local LeRobot data set, version 2.1 or 3; every episode is a run.

    Without a model each joint is a position servo: the action is its reference, the observed state its position. With
    one the joints of an arm carry each other, and the model's actuators turn the action into efforts; a model without
    actuators is not used.

    Args:
        path: folder of the data set.
        model: MJCF or URDF as `diagnose` takes it; None: servos by themselves.
        unit: of actions and states, `rad` or `deg`; default guessed, since the data set does not say.
        episodes: numbers of the episodes to take; default all.
        joints: the model's joint of each entry of the state; default by the names of the data set where the model has
            them all, else guessed, see `diagnose`.
        tags: what differs between episodes, as `diagnose` takes it.
        without: ids of effects that are left out of the library.

    Returns:
        The answer; periods that the loop missed are its last cause, `dropped_commands`: their share, and the longest.

    Raises:
        InputError: arguments do not fit the data set.
        MachineError: the data set cannot be read or used; the sentence says why and what to do.
    """
    if unit is not None and unit not in ANGLES:
        raise InputError("unit of the joints is not known", value=unit, limit=", ".join(ANGLES), remedy="convert them")
    found = read_data_set(Path(path), episodes)
    guesses: list[str] = []
    scale = UNITS[unit or _guessed(found, guesses)]
    runs = [{n: x if n == CLOCK else scale * x for n, x in tables.items()} for tables in found.episodes.values()]
    if model is not None and not any(d.drive for d in source_of(model).bodies.drives.values()):
        model = None
        guesses.append("the model is not used, because it has no actuator whose force is known: each joint is a servo")
    if model is None:
        case = case_of_tables(None, runs, None, Stated(), tags)
    else:
        stated = Stated(tuple(joints)) if joints else _joints_by_name(source_of(model).bodies.joints, runs[0], guesses)
        case = case_of_arrays(model, [_arrays(tables) for tables in runs], stated, tags)
    notes = list(case.notes)
    if not episodes and len(runs) < found.total:
        notes.append(f"{len(runs)} of the data set's {found.total} episodes are in its folder")
    if found.nominal:
        notes.append(f"stamps are the frame's number over {found.rate:g} Hz: they hide what the control loop missed")
    missed = computed(SHARE).id
    answer = Answer.of(
        replace(case, guesses=[*guesses, *case.guesses], notes=notes), [x for x in without if x != missed]
    )
    if missed in without:
        return answer
    verdict = with_missed(answer.verdict, [tables[CLOCK] for tables in runs])
    return replace(answer, diagnosis=replace(answer.diagnosis, verdict=verdict))


def _guessed(found: DataSet, guesses: list[str]) -> str:
    """Return the unit of states: no joint of an arm turns so far that its radians look like degrees."""
    reached = max(reach(x) for tables in found.episodes.values() for n, x in tables.items() if n.startswith(STATE))
    unit = "deg" if reached > MOST_TURNS * 2.0 * np.pi else "rad"
    guesses.append(f"actions and states are in {unit}, because values reach {reached:.4g}; unit='rad' or 'deg'")
    return unit


def _joints_by_name(known: Collection[str], tables: Mapping[str, Array], guesses: list[str]) -> Stated:
    """Return the joints of states and actions by the names of the data set; nothing where the model lacks any."""
    state, action = ([n[len(w) :].removesuffix(".pos") for n in tables if n.startswith(w)] for w in (STATE, ACTION))
    if not set(state) <= set(known):
        return Stated()
    guesses.append(f"joints are those of the data set's names: {', '.join(state)}")
    return Stated(tuple(state), controls=tuple(action) if set(action) == set(state) else ())


def _arrays(tables: Mapping[str, Array]) -> Arrays:
    state, action = (np.column_stack([x for n, x in tables.items() if n.startswith(w)]) for w in (STATE, ACTION))
    return Arrays(tables[CLOCK], state, action)
