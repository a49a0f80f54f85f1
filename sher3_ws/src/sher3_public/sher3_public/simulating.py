"""Paired replays: what was recorded, what the model does untuned, and with the causes in it, on the same commands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.verdict import Verdict
from sher3_diagnosis.words import quantity
from sher3_export.check.check import bench_on
from sher3_export.check.engine import copied, windows
from sher3_export.check.model_of import model_of, model_of_text
from sher3_export.check.recorded import Recorded, recorded
from sher3_export.writing import export

from sher3_public.cases import Case
from sher3_public.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDE, HIGH = 8.0, 2.0
"""Width of a figure and height of one picture of it, inch."""


@dataclass(frozen=True)
class Replay:
    """One joint over windows of a quarter of a second that start at recorded states, in all runs.

    Attributes:
        time: (w, n), s from the start of its run.
        recorded, untuned, corrected: (w, n), in `unit`.
        unit: rad or m.
    """

    time: Array
    recorded: Array
    untuned: Array
    corrected: Array
    unit: str

    @property
    def before(self) -> float:
        """Rms of recorded less untuned, in `unit`."""
        return float(np.sqrt(np.mean((self.recorded - self.untuned) ** 2)))

    @property
    def after(self) -> float:
        """Rms of recorded less corrected, in `unit`."""
        return float(np.sqrt(np.mean((self.recorded - self.corrected) ** 2)))


@dataclass(frozen=True)
class Replays:
    """Replays by joint, and what the corrected model could not be given, one sentence each."""

    joints: Mapping[str, Replay]
    not_expressed: Sequence[str]

    def __str__(self) -> str:
        rows = [
            f"{name}: {quantity(r.before, r.unit)} rms untuned, {quantity(r.after, r.unit)} corrected"
            for name, r in self.joints.items()
        ]
        return "\n".join([*rows, *(f"not expressed: {x}" for x in self.not_expressed)])

    def plot(self) -> Figure:
        """Return a figure with a picture for each joint: position over time, the windows side by side."""
        from matplotlib.figure import Figure

        figure = Figure(figsize=(WIDE, HIGH * len(self.joints)), layout="constrained")
        pictures = figure.subplots(len(self.joints), 1, squeeze=False)[:, 0]
        for axes, (name, replay) in zip(pictures, self.joints.items(), strict=True):
            for what, colour in (("recorded", "0"), ("untuned", "0.65"), ("corrected", "C0")):
                lines = axes.plot(replay.time.T, getattr(replay, what).T, color=colour, lw=0.8)
                lines[0].set_label(what)
            axes.set_title(name, fontsize="small", loc="left")
            axes.set_ylabel(replay.unit)
        pictures[0].legend(fontsize="small")
        pictures[-1].set_xlabel("time, s")
        return figure


def replays(verdict: Verdict, case: Case) -> Replays:
    """Return paired replays of a case in MuJoCo.

    Raises:
        InputError: an `MjModel` was given, of which no text is known.
        ExportError: MuJoCo is missing or refuses the model, or the machine is neither axes nor an arm.
    """
    bench = bench_on(verdict, _root(case), case.machine, case.runs, {})
    done = export(verdict, "mjcf", copied(bench.root))
    tuned = bench.compiled(done.text)
    pairs = [(record, bench.nominal.run(record), tuned.run(record)) for record in bench.records]
    found = {name: _joined([_of(name, *pair) for pair in pairs]) for name in bench.joints}
    return Replays(found, [str(x) for x in done.not_expressed])


def _root(case: Case) -> Any:
    if case.source is None:
        recorded(case.machine, [], {}, False)  # refuses another kind of machine
        return model_of(case.machine.gather(case.runs))
    if case.source.text is None:
        remedy = "give the model as a path, a text or an MjSpec"
        raise InputError("replays need the text of the model", value="an MjModel", remedy=remedy)
    return model_of_text(case.source.text, case.source.name, case.source.path)


def _of(joint: str, record: Recorded, untuned: Mapping[str, Array], corrected: Mapping[str, Array]) -> Replay:
    starts, length = windows(record)
    rows = starts[:, None] + np.arange(length)
    track = record.tracks[joint]
    measured = track.measured[rows]
    time: Array = record.period * rows.astype(float)
    return Replay(time, measured, measured - untuned[joint], measured - corrected[joint], track.unit)


def _joined(runs: Sequence[Replay]) -> Replay:
    """Return the windows of all runs, those of a longer period cut to the shortest."""
    n, first = min(r.time.shape[1] for r in runs), runs[0]
    parts = ("time", "recorded", "untuned", "corrected")
    whole = {part: np.concatenate([getattr(r, part)[:, :n] for r in runs]) for part in parts}
    return Replay(**whole, unit=first.unit)
