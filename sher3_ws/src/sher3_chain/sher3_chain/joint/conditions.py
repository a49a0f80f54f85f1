"""The conditions that the runs of a case were recorded under."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, NamedTuple, TypeVar

from pydantic import Field
from sher3_machines.errors import MachineError
from sher3_machines.intake.fields import Description
from sher3_machines.intake.mending.parts import whole

T = TypeVar("T")
Tag = Annotated[str, Field(min_length=1, max_length=40)]
"""What may differ between runs: payload, posture, temperature, day, controller, gain, or any other word."""
Conditions = Mapping[str, Mapping[Tag, str | float]]
"""Run -> tag -> its value."""


class Tagged(Description):
    """A description whose runs may differ in a condition.

    Attributes:
        conditions: file name of a run, without its ending -> tag -> value. Those of the first file given to the import
            are the reference that the others are compared with.
    """

    conditions: Conditions = Field(default_factory=dict)


class Condition(NamedTuple):
    """Runs that share a value of a tag which differs from the reference.

    Attributes:
        tag, value: as stated; `reference` is the value it is compared with.
        runs: names of its runs.
    """

    tag: str
    value: str
    reference: str
    runs: frozenset[str]

    def __str__(self) -> str:
        return f"{self.tag} {self.value}"


def carried_in(stated: Mapping[str, T], runs: Sequence[str]) -> list[T | None]:
    """Return what was put on in each run; None: nothing. Raises MachineError where a stated run was not imported."""
    unknown = sorted(stated.keys() - {whole(run) for run in runs})
    if unknown:
        raise MachineError("`carried` names no run", value=unknown[0], limit=runs, remedy="name runs as their files")
    return [stated.get(whole(run)) for run in runs]


def conditions_of(stated: Conditions, runs: Sequence[str]) -> list[Condition]:
    """Return every condition that differs from the condition of the first run; none where nothing was stated.

    Raises:
        MachineError: a stated run was not imported, or a run lacks a tag that another one has.
    """
    if not stated:
        return []
    stated = {**stated, **{run: stated[whole(run)] for run in runs if run not in stated and whole(run) in stated}}
    unknown = sorted({run for run in stated if not any(run in (x, whole(x)) for x in runs)})
    if unknown:
        raise MachineError(
            f"conditions: no run {unknown[0]!r}", limit=f"runs: {', '.join(runs)}", remedy="name runs as their files"
        )
    tags = sorted({tag for found in stated.values() for tag in found})
    for run in runs:
        lacking = set(tags) - set(stated.get(run, {}))
        if lacking:
            tag = min(lacking)
            raise MachineError(
                f"conditions: run {run!r} has no {tag}", limit=", ".join(tags), remedy=f"state its {tag}"
            )
    out = []
    for tag in tags:
        of = {run: str(stated[run][tag]) for run in runs}
        for value in dict.fromkeys(of.values()):
            if value != of[runs[0]]:
                there = frozenset(run for run, x in of.items() if x == value)
                out.append(Condition(tag, value, of[runs[0]], there))
    return out


def reference_runs(conditions: Sequence[Condition], runs: Sequence[str]) -> list[str]:
    """Return the runs under the reference of every tag."""
    return [run for run in runs if not any(run in c.runs for c in conditions)]


def confounded_conditions(conditions: Sequence[Condition]) -> list[str]:
    """Return in words which conditions have the same runs, so that nothing tells their effects apart."""
    out = []
    for i, a in enumerate(conditions):
        out += [
            f"{a} and {b} have the same runs: nothing tells them apart" for b in conditions[i + 1 :] if a.runs == b.runs
        ]
    return out
