"""How much of the motion a randomised model covers, on windows that its remainder was not set on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from sher3_diagnosis import diagnose
from sher3_diagnosis.channel import Array
from sher3_diagnosis.verdict import Verdict
from sher3_machines import open_case

from sher3_export.check.check import Bench, bench_of
from sher3_export.check.engine import Engine, copied, windows
from sher3_export.ranges import SHARE, Ranges, worlds_of
from sher3_export.writing import export, put

DRAWS = 60
"""Models that are drawn: the band's ends are then its third lowest and highest."""
DRAWN = 12
"""Models whose spread is taken off the remainder: a standard deviation to a fifth."""
SET_ON = 2.0 / 3.0
"""Share of the windows of each run that the remainder is set on; the others are held out."""
PUSH = 1e-2
"""Force that a joint's answer to a force is measured with, in units of what moves it by its own error."""


class Covered(NamedTuple):
    """Ranges, and the share of held-out samples that lie in the band of the drawn models, by joint."""

    ranges: Ranges
    coverage: Mapping[str, float]


def covered(verdict: Verdict, case: Path, model: Path | None, joints: Mapping[str, str]) -> Covered:
    """Return the ranges of a verdict with its rivals and its remainder, and the motion they cover.

    The remainder is set on the first two thirds of each run and the coverage counted on the last.

    Raises:
        MachineError, ExportError: see `check`.
    """
    bench = bench_of(verdict, case, model, joints)
    ranges = Ranges(worlds_of(verdict, without_each(verdict, case)))
    text = export(verdict, "mjcf", copied(bench.root), joints).text
    ranges = replace(ranges, remainder=remainder_of(bench, text, ranges, joints))
    return Covered(ranges, coverage(bench, ranges, joints))


def without_each(verdict: Verdict, case: Path) -> list[Verdict]:
    """Diagnose again without each cause that has rivals: what then explains the runs is the rival, with its numbers."""
    rivalled = [cause.effect for cause in verdict.causes if cause.rivals]
    if not rivalled:
        return []
    machine, runs = open_case(case)
    return [diagnose(machine, runs, [effect]).verdict for effect in rivalled]


def remainder_of(bench: Bench, text: str, ranges: Ranges, joints: Mapping[str, str]) -> dict[str, float]:
    """Return the force in a window that neither the corrected model nor its ranges account for, standard deviation.

    In each window the error is split into the answer to a constant force and the rest. The standard deviation is that
    of a normal distribution whose 90 % the windows fill, less what the drawn parameters make of it.
    """
    rng = np.random.default_rng(1)
    central = missing_force(bench, bench.compiled(text))
    drawn = [missing_force(bench, drawn_model(bench, ranges, joints, rng)) for _ in range(DRAWN)]
    out = {}
    for joint, force in central.items():
        spread = np.mean(np.var(np.stack([x[joint] for x in drawn]), axis=0))
        whole = float(np.quantile(np.abs(force), SHARE)) / 1.645
        out[joint] = float(np.sqrt(max(0.0, whole**2 - spread)))
    return out


def missing_force(bench: Bench, engine: Engine) -> dict[str, Array]:
    """Return the force that a model lacks in each window that the remainder is set on, by joint, (windows,)."""
    found: dict[str, list[Array]] = {joint: [] for joint in bench.joints}
    for record in bench.records:
        free = engine.run(record)
        for joint, error in free.items():
            unit = force_scale(error, record.period)
            answer = error - engine.run(record, {joint: np.full(len(error), unit)})[joint]
            keep = np.arange(len(error)) < SET_ON * len(error)
            found[joint].append((unit * np.sum(error * answer, axis=1) / np.sum(answer**2, axis=1))[keep])
    return {joint: np.concatenate(x) for joint, x in found.items()}


def drawn_model(bench: Bench, ranges: Ranges, joints: Mapping[str, str], rng: np.random.Generator) -> Engine:
    """Return a compiled model with drawn causes."""
    return bench.compiled(put(ranges.draw(rng), "mjcf", copied(bench.root), joints)[1](["drawn"]))


def force_scale(error: Array, period: float) -> float:
    """Return a force that shows: any but zero would do for a linear joint, dry friction needs one that moves it."""
    duration = error.shape[1] * period
    return max(PUSH, float(np.abs(error).max()) / duration**2)


def coverage(bench: Bench, ranges: Ranges, joints: Mapping[str, str], seed: int = 0) -> dict[str, float]:
    """Return the share of held-out samples within the 5 to 95 % band of drawn models, by joint."""
    rng = np.random.default_rng(seed)
    found: dict[str, list[Array]] = {joint: [] for joint in bench.joints}
    for _ in range(DRAWS):
        for joint, errors in held_out(bench, drawn_model(bench, ranges, joints, rng), ranges, rng).items():
            found[joint].append(errors)
    ends = ((1.0 - SHARE) / 2.0, (1.0 + SHARE) / 2.0)
    bands = {joint: np.quantile(np.stack(draws), ends, axis=0) for joint, draws in found.items()}
    return {joint: float(np.mean((low <= 0.0) & (high >= 0.0))) for joint, (low, high) in bands.items()}


def held_out(bench: Bench, engine: Engine, ranges: Ranges, rng: np.random.Generator) -> dict[str, Array]:
    """Return the errors of one drawn model on held-out windows with a drawn remainder, by joint, (samples,)."""
    parts: dict[str, list[Array]] = {joint: [] for joint in bench.joints}
    for record in bench.records:
        number = len(windows(record)[0])
        push = {joint: s * rng.standard_normal(number) for joint, s in ranges.remainder.items()}
        for joint, error in engine.run(record, push).items():
            parts[joint].append(error[np.arange(number) >= SET_ON * number].ravel())
    return {joint: np.concatenate(x) for joint, x in parts.items()}
