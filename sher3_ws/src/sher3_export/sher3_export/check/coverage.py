"""How much of the motion a randomised model covers, on windows that were not used to set its residual scatter."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis import diagnose
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.verdict import Verdict
from sher3_machines import open_case

from sher3_export.check.check import Bench, bench_of
from sher3_export.check.engine import Engine, copied
from sher3_export.ranges import SHARE, Ranges, shares_of, worlds_of
from sher3_export.writing import Motors, export, put

DRAWS = 60
"""Models that are drawn: the band's ends are then its third lowest and highest."""
SET_ON = 2.0 / 3.0
"""Share of the windows of each run that the remainder is set on; the others are held out."""
PUSH = 1e-2
"""Force that a joint's answer to a force is measured with, in units of what moves it by its own error."""
WIDEST, HALVINGS = 8.0, 12
"""Largest scatter over that of the windows, and halvings of the search for the one that covers its share."""


class Covered(NamedTuple):
    """Ranges, and the share of held-out samples that lie in the band of the drawn models, by joint."""

    ranges: Ranges
    coverage: Mapping[str, float]


@dataclass(frozen=True)
class Windows:
    """All windows of one joint, sample after sample.

    Attributes:
        errors: of every drawn model, (DRAWS, N), m or rad.
        central: of the model with the verdict's own numbers, (N,).
        answer: what a newton (newton metre) beside the model's forces takes off the error, (N,).
        time: since the window began, (N,), s.
        window: number of the window, (N,).
        held_out: whether the remainder is not set on the window, (N,).
    """

    errors: Array
    central: Array
    answer: Array
    time: Array
    window: NDArray[np.int64]
    held_out: Mask


class Scatter(NamedTuple):
    """What varies from window to window, standard deviations: start speed, force, and the reading itself.

    Attributes:
        width: share of the parameters' intervals that is drawn from.
    """

    speed: float
    force: float
    reading: float
    width: float = 1.0

    def times(self, factor: float) -> Scatter:
        """Return a scatter scaled by a factor; a negative one narrows the parameters too, and -1 leaves none."""
        more = max(factor, 0.0)
        return Scatter(more * self.speed, more * self.force, more * self.reading, min(1.0, 1.0 + factor))


def covered(
    verdict: Verdict, case: Path, model: Path | None, joints: Mapping[str, str], motors: Motors | None = None
) -> Covered:
    """Return the ranges of a verdict with its rivals and its remainder, and the motion they cover.

    The remainder is as large as it must be for the ranges to cover their share of the first two thirds of each run;
    the coverage is counted on the last.

    Raises:
        MachineError, ExportError: see `check`.
    """
    bench = bench_of(verdict, case, model, joints, motors)
    worlds = worlds_of(verdict, without_each(verdict, case))
    ranges = Ranges(
        worlds, shares_of(verdict, worlds), identified=verdict.identified, noise=verdict.noise, motors=motors or {}
    )
    text = export(verdict, "mjcf", copied(bench.root), joints, motors).text
    found = windows_of(bench, text, ranges, joints)
    scatters = {joint: scatter_of(x, len(ranges.worlds) == 1) for joint, x in found.items()}
    shares = {joint: inside(x, scatters[joint])[x.held_out].mean() for joint, x in found.items()}
    remainder = {joint: s.force for joint, s in scatters.items()}
    ranges = replace(ranges, remainder=remainder, width=max(s.width for s in scatters.values()))
    return Covered(ranges, {joint: float(share) for joint, share in shares.items()})


def without_each(verdict: Verdict, case: Path) -> list[Verdict]:
    """Diagnose again without each cause that has rivals: what then explains the runs is the rival, with its numbers."""
    rivalled = [cause.effect for cause in verdict.causes if cause.rivals]
    if not rivalled:
        return []
    machine, runs = open_case(case)
    return [diagnose(machine, runs, [effect]).verdict for effect in rivalled]


def windows_of(bench: Bench, text: str, ranges: Ranges, joints: Mapping[str, str]) -> dict[str, Windows]:
    """Run the corrected model and drawn ones over all windows, by joint."""
    rng = np.random.default_rng(0)
    central, forces = run_all(bench, bench.compiled(text)), {}
    pushed = {}
    for joint, parts in central.items():
        forces[joint] = [force_scale(error, r.period) for error, r in zip(parts, bench.records, strict=True)]
        pushed[joint] = [
            bench.compiled(text).run(r, {joint: np.full(len(error), force)})[joint]
            for r, error, force in zip(bench.records, parts, forces[joint], strict=True)
        ]
    drawn = [run_all(bench, drawn_model(bench, ranges, joints, rng)) for _ in range(DRAWS)]
    out = {}
    for joint, parts in central.items():
        shapes, periods = [x.shape for x in parts], [r.period for r in bench.records]
        firsts = np.cumsum([0, *(w for w, _ in shapes)])
        out[joint] = Windows(
            errors=np.stack([_flat(x[joint]) for x in drawn]),
            central=_flat(parts),
            answer=_flat([(x - y) / f for x, y, f in zip(parts, pushed[joint], forces[joint], strict=True)]),
            time=_flat([np.tile(p * np.arange(n), (w, 1)) for (w, n), p in zip(shapes, periods, strict=True)]),
            window=_flat([np.repeat(f + np.arange(w), n) for (w, n), f in zip(shapes, firsts, strict=False)]).astype(
                int
            ),
            held_out=_flat([np.repeat(np.arange(w) >= SET_ON * w, n) for w, n in shapes]).astype(bool),
        )
    return out


def run_all(bench: Bench, engine: Engine) -> dict[str, list[Array]]:
    """Return the errors of a model in every record, by joint, (windows, samples) each."""
    found = [engine.run(record) for record in bench.records]
    return {joint: [x[joint] for x in found] for joint in bench.joints}


def _flat(parts: list[Array]) -> Array:
    return np.concatenate([np.ravel(x) for x in parts])


def scatter_of(windows: Windows, narrowed: bool = True) -> Scatter:
    """Return what must vary from window to window for the drawn models to cover their share of those it is set on.

    In each window the error is split into what a start speed and a constant force make of it, and the rest; all three
    are then scaled by one factor. Where the parameters' intervals alone cover more than their share, they are
    `narrowed`; which of several worlds is at work no width changes.
    """
    seen = replace(windows, **{k: x[..., ~windows.held_out] for k, x in vars(windows).items()})
    rows = []
    for w in np.unique(seen.window):
        here = seen.window == w
        x, y = np.column_stack([seen.time, seen.answer])[here], seen.central[here]
        found = np.linalg.lstsq(x, y, rcond=None)[0]
        rows.append([*found, np.std(y - x @ found)])
    usual = Scatter(*(float(x) for x in np.sqrt(np.mean(np.square(rows), axis=0))))
    low, high = -1.0 if narrowed else 0.0, WIDEST
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        enough = inside(seen, usual.times(middle)).mean() >= SHARE
        low, high = (low, middle) if enough else (middle, high)
    return usual.times(high)


def inside(windows: Windows, scatter: Scatter) -> Mask:
    """Return whether the band of the drawn models holds the measured motion, (N,)."""
    rng = np.random.default_rng(1)
    speed, force = (rng.standard_normal((DRAWS, int(windows.window.max()) + 1))[:, windows.window] for _ in range(2))
    reading = rng.standard_normal(windows.errors.shape)
    moved = scatter.speed * speed * windows.time + scatter.force * force * windows.answer + scatter.reading * reading
    drawn = windows.central + scatter.width * (windows.errors - windows.central)
    low, high = np.quantile(drawn + moved, ((1.0 - SHARE) / 2.0, (1.0 + SHARE) / 2.0), axis=0)
    return np.asarray((low <= 0.0) & (high >= 0.0))


def drawn_model(bench: Bench, ranges: Ranges, joints: Mapping[str, str], rng: np.random.Generator) -> Engine:
    """Return a compiled model with drawn causes."""
    drawn = put(ranges.draw(rng), "mjcf", copied(bench.root), joints, ranges.motors, ranges.draw_inertias(rng))
    return bench.compiled(drawn[1](["drawn"]))


def force_scale(error: Array, period: float) -> float:
    """Return a force for a trial run from errors (windows, n): any for a linear joint, else one above dry friction."""
    duration = error.shape[1] * period
    return max(PUSH, float(np.abs(error).max()) / duration**2)
