"""The machine's own sections of the report.

The report itself is the same for every machine. A machine hands it a `Reporter`; each default suits a machine about
which nothing particular is to be said, so a new machine needs none of its own.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from sher3_diagnosis.channel import STAGES, Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Findings

E = TypeVar("E", bound=Evidence)

FLOWS: Mapping[str, str] = {
    "transport": "command → demand",
    "controller": "set-point → command",
    "drive": "demand → force",
    "motor_mechanics": "force ↔ motion",
    "transmission": "motor → load encoder",
    "mechanism": "load encoders → tip",
    "structure": "load → tip deflection",
    "sensing": "truth → reading",
}
"""Stage -> what goes in and what comes out."""


@dataclass(frozen=True)
class Isolability:
    """What the recorded signals can tell apart before anything is fitted.

    Attributes:
        sources: names of the recorded signals.
        groups: effect ids that show in the same equations, largest group first: only the shape of their signature tells
            them apart; groups of one are told apart.
        invisible: effect ids that none of these signals shows.
    """

    sources: Sequence[str]
    groups: Sequence[frozenset[str]]
    invisible: frozenset[str]

    def alike(self, effect: str) -> frozenset[str]:
        """Return the other effects of the group an effect belongs to; the invisible ones are one group."""
        return next((g for g in self.groups if effect in g), self.invisible) - {effect}


@dataclass(frozen=True)
class Output:
    """What a stage puts out in one run.

    Attributes:
        name: of the quantity, for the axis of a picture.
        values: (g,) on the residual grid, in the unit of the channel; None where the deviation from the model is itself
            the picture.
    """

    name: str
    values: Array | None = None


@dataclass(frozen=True)
class Trace:
    """One picture with its caption."""

    title: str
    caption: str
    svg: str


TO_YAML = "--to yaml"
"""Options of `sher3 gap export` for a machine without a model that takes the causes."""
EMPTY = "–"
"""Cell in which nothing was found."""


@dataclass(frozen=True)
class Table:
    """Causes by place and kind, in words.

    Attributes:
        heads: of the columns, the place first.
        rows: cells in words, as many as heads; a dash where nothing was found.
        found: places with a cause.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    found: Collection[str]

    def lines(self) -> list[str]:
        """Return a line for each place with a cause: the place, and what was found there."""
        filled = ([row[0], [x for x in row[1:] if x != EMPTY]] for row in self.rows if row[0] in self.found)
        return [f"{name}: {'; '.join(cells)}" for name, cells in filled]


class Reporter(Generic[E]):
    """What a machine adds to its report.

    Attributes:
        stages: in the order of the signal.
        flows: stage -> what goes in and what comes out.
        places: in the order they are listed; places not named here follow by name.
        every_stage: list the stages of which nothing was recorded too.
        simulated: whether `sher3 gap apply` and `sher3 gap experiment` know the machine's simulator.
        formulas: whether `sher3 gap discover` finds a formula for what the library lacks.
        target: options by which `sher3 gap export` writes the causes into the machine's model.
        abscissa: label of what pictures run over.
        end: where the closure of the machine run from end to end is read.
        held_out: what is left out of a fit in turn, in the plural.
    """

    stages: Sequence[str] = STAGES
    flows: Mapping[str, str] = FLOWS
    places: Sequence[str] = ()
    every_stage: bool = False
    simulated: bool = False
    formulas: bool = True
    target: str = TO_YAML
    abscissa: str = "time [s]"
    end: str = "at the tip"
    held_out: str = "runs"

    def data(self, parts: Sequence[E]) -> str:
        """Return in words what was recorded."""
        runs = parts[0].excitations if parts else ()
        return f"{len(runs)} {self.held_out}: {counted(runs)}"

    def exact_places(self, parts: Sequence[E]) -> Mapping[str, Sequence[str]]:
        """Return, per stage that is computed without a fit, the places judged; none where it was not recorded."""
        return {}

    def purpose(self, excitation: str) -> str:
        """Return what an excitation is for; empty when the machine has no such excitation."""
        return ""

    def isolability(self, parts: Sequence[E]) -> Isolability | None:
        """Return what the recorded signals can tell apart; None when the machine does not say."""
        return None

    def run_name(self, evidence: E, run: int) -> str:
        """Return a run's name for a caption."""
        return f"Run {run + 1} ({evidence.excitations[run]})"

    def together(self, evidence: E, run: int) -> Sequence[int]:
        """Return the runs drawn in one picture with `run`, in order: the blocks of one record, for example."""
        return [run]

    def clock(self, evidence: E, run: int) -> Array | None:
        """Return the abscissa of the residual grid, (g,); None counts samples at the rate of the view."""
        return None

    def output(self, evidence: E, run: int, channel: Channel) -> Output:
        """Return what a stage puts out in a run; default its deviation from the model."""
        return Output("measured − nominal")

    def table(self, diagnosis: Findings[E]) -> Table | None:
        """Return the causes as a table, where a machine has many places alike; None where a list is as short."""
        return None

    def picture(self, diagnosis: Findings[E]) -> str:
        """Return the machine as a drawing (SVG) with the places of its gaps lit; empty when there is none."""
        return ""

    def own_traces(self, diagnosis: Findings[E]) -> tuple[list[Trace], list[Trace]]:
        """Return pictures of the machine's own: first ones, of exact stages for example, and last ones, of its end."""
        return [], []


def counted(excitations: Sequence[str]) -> str:
    """Return excitations with their number of runs: `steps × 3, sweep × 2`."""
    return ", ".join(f"{name} × {list(excitations).count(name)}" for name in sorted(set(excitations)))
