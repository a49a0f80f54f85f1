"""What one call answers: the verdict, what it rests on, and what can be made of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sher3_diagnosis.flow import diagnose
from sher3_diagnosis.machine import Diagnosis
from sher3_diagnosis.report.summary import cause_text, five_lines, headline
from sher3_diagnosis.verdict import Cause, Noise, Verdict, Where
from sher3_diagnosis.words import place, quantity, words

from sher3_public.cases import Case
from sher3_public.correcting import Corrected, corrected
from sher3_public.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from sher3_public.simulating import Replays


@dataclass(frozen=True)
class Answer:
    """The answer of a diagnosis; `print` shows it, a notebook shows it with its pictures.

    Attributes:
        case: machine and runs.
        diagnosis: the verdict with what it rests on.
    """

    case: Case
    diagnosis: Diagnosis[Any]

    @classmethod
    def of(cls, case: Case, without: Sequence[str] = ()) -> Answer:
        """Diagnose a case; raises UnknownEffect for an id in `without` that is no effect."""
        return cls(case, diagnose(case.machine, case.runs, without))

    @property
    def verdict(self) -> Verdict:
        """The verdict as data, also as `verdict.to_json()`."""
        return self.diagnosis.verdict

    @property
    def status(self) -> str:
        """`no_gap`, `attributed`, `under_excited` (these runs cannot tell), `outside_library` (no effect does)."""
        return self.verdict.status

    @property
    def headline(self) -> str:
        """The answer in one sentence."""
        return headline(self.verdict, self._rests)

    @property
    def causes(self) -> Sequence[Cause]:
        """Effects that explain the gap: `effect`, `actuator`, `parameters` in SI units, `closure`, `rivals`."""
        return self.verdict.causes

    @property
    def places(self) -> Sequence[Where]:
        """Where the robot leaves its model: `stage`, `actuator`, `gap` and `floor` in `unit`, `regime`."""
        return self.verdict.where

    @property
    def noise(self) -> Sequence[Noise]:
        """How noisy each reading is: `actuator`, `reading`, `deviation` (standard) and `resolution` in `unit`."""
        return self.verdict.noise

    @property
    def guessed(self) -> Sequence[str]:
        """What was taken for what, one sentence each; keywords of `diagnose` put it right."""
        return tuple(self.case.guesses)

    @property
    def notes(self) -> Sequence[str]:
        """What was done to the data, and what the answer cannot say."""
        return (*self.case.notes, *self.verdict.notes)

    @property
    def _rests(self) -> dict[str, str]:
        return {e.id: e.leaves_out for e in self.diagnosis.machine.library() if e.leaves_out}

    def __str__(self) -> str:
        reporter = self.diagnosis.machine.reporter()
        lines = [f"{label:9}{text}" for label, text in five_lines(self.verdict, reporter, self._rests)[:4]]
        lines += [f"odds     {odds:.0%}: {cause_text(c)}" for c in self.causes if (odds := c.probability) is not None]
        return "\n".join([*lines, *(f"guessed  {text}" for text in self.guessed)])

    def __repr__(self) -> str:
        return f"Answer({self.status}: {self.headline})"

    def _repr_html_(self) -> str:
        from sher3_public.showing import html_of

        lists = {"causes": [cause_text(cause) for cause in self.causes], "places": self.where()}
        return html_of(self.diagnosis, self.headline, lists, {"guessed": self.guessed, "notes": self.notes})

    def plot(self) -> Figure:
        """Return a figure of the largest gaps: what the model leaves unexplained, before and after the causes."""
        from sher3_public.showing import figure_of

        return figure_of(self.diagnosis)

    def report(self, path: str | Path | None = None) -> str:
        """Return the report as one HTML page without external resources; write it where a path is given."""
        from sher3_diagnosis.report.page import render

        name = self.case.source.name if self.case.source is not None else "table"
        return _written(render(self.diagnosis, name, in_memory=True), path)

    def corrected(self, path: str | Path | None = None, to: str = "") -> Corrected:
        """Return the model with the causes in it; write it where a path is given.

        Args:
            path: file to write.
            to: `mjcf`, `urdf`, `sdf`, `isaaclab`, `isaac`, `mjlab`, `ros2_control` or `yaml`; default the format
                of the model that was given, else `yaml`.

        Raises:
            InputError: the target needs a model that was not given as text or file.
            ExportError: no such target, or the model has none of the joints.
        """
        found = corrected(self.verdict, self.case.source, to)
        _written(found.text, path)
        return found

    def simulate(self) -> Replays:
        """Return paired replays in MuJoCo: recorded, untuned and corrected motion on the same commands, by joint.

        Raises:
            InputError: an `MjModel` was given, of which no text is known.
            ExportError: MuJoCo is missing or refuses the model, or the machine is neither axes nor an arm.
        """
        from sher3_public.simulating import replays

        return replays(self.verdict, self.case)

    def to_rows(self) -> list[dict[str, Any]]:
        """Return one row for each parameter of each cause: cause, place, parameter, value, low, high, unit, rivals."""
        return [
            {
                "cause": cause.effect,
                "place": cause.actuator,
                "condition": cause.condition,
                "parameter": name,
                "value": p.value,
                "low": p.low,
                "high": p.high,
                "unit": p.unit,
                "closure": cause.closure.value,
                "probability": cause.probability,
                "rivals": ", ".join(cause.rivals),
            }
            for cause in self.causes
            for name, p in cause.parameters.items()
        ]

    def to_frame(self) -> Any:
        """Return the rows as a pandas frame; raises InputError where pandas is not installed."""
        try:
            frame = import_module("pandas").DataFrame
        except ImportError as error:
            remedy = "install pandas, or use to_rows()"
            raise InputError("frames need pandas", value="not installed", remedy=remedy) from error
        return frame(self.to_rows(), columns=list(self.to_rows()[0]) if self.causes else None)

    def where(self) -> list[str]:
        """Return every place in words, with its gap, its floor and the regime in which it is largest."""
        return [
            f"{words(w.stage).lower()}, {place(w.actuator)}: {quantity(w.gap, w.unit)} rms over a floor of "
            f"{quantity(w.floor, w.unit)}, {w.regime}"
            for w in self.places
        ]


def _written(text: str, path: str | Path | None) -> str:
    if path is not None:
        try:
            Path(path).write_text(text, encoding="utf-8")
        except OSError as error:
            raise InputError(
                f"{path}: cannot be written", value=error.strerror, remedy="choose another path"
            ) from error
    return text
