"""The recorded command against the law that its description states: an exact stage, judged by itself.

The law needs no model of the machine: reference and reading in, command out. Nobody states how a controller takes its
speed from its encoder, nor at which sample within a period it reads: of the usual samplings the one is taken whose law
leaves least, whatever the gains are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sher3_diagnosis.attribute.plan import SearchPlan
from sher3_diagnosis.attribute.polish import polished
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.evidence import Evidence

from sher3_chain.axes.command.best_sampling import backwards, best_sampling
from sher3_chain.axes.command.residual import LawView, floor_of, residual_of
from sher3_chain.axes.command.sampling import Sampling
from sher3_chain.axes.evidence import AxisEvidence
from sher3_chain.chain.evidence import in_blocks
from sher3_chain.constants import INTEGRAL, constants
from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.signals import signals_of

STAGE = "controller"
"""Stage of the law."""
LAW = SearchPlan(down_to_floor=True, single=polished)
"""How the causes of a command are looked for: a law is exact, so that one cause with its best shape may do."""


@dataclass(frozen=True, kw_only=True)
class LawEvidence(AxisEvidence):
    """The engine's evidence for the command of one axis."""


def law_of_axis(runs: Sequence[AxesRun], axis: Axis) -> LawEvidence | None:
    """Return the evidence for the command of an axis; None where no law is stated or nothing was recorded."""
    if not compared(axis) or not all({"reference", "command"} <= run.signals[axis.name].keys() for run in runs):
        return None
    signals = [signals_of(run, axis, run.name) for run in runs]
    sampling = best_sampling(signals, axis)
    turned = backwards(signals, axis, sampling)
    if turned:
        signals = [replace(s, command=-s.command) for s in signals if s.command is not None]
    views = [LawView(s, axis, sampling) for s in signals]
    channel = Channel(STAGE, axis.name)
    found = [{channel: residual_of(view)} for view in views]
    floors = [{channel: floor_of(view, x[channel])} for view, x in zip(views, found, strict=True)]
    data = in_blocks(views, found, floors)
    return LawEvidence(
        excitations=[view.excitation for view in data.views],
        data=data,
        nuisance=constants(data, INTEGRAL, [channel]) if axis.command_law.integral_gain else (),
        units={channel: unit_of_command(axis)},
        places={"axis": (axis.name,)},
        rotary=frozenset({axis.name} if axis.motion == "rotary" else ()),
        axis=axis,
        runs=list(runs),
        records=views,
        mass=0.0,
        notes=notes_of(axis, sampling, turned),
    )


def notes_of(axis: Axis, sampling: Sampling, turned: bool) -> list[str]:
    """Return how a command was read."""
    notes = (
        [f"{axis.name}: the speed in its law is taken {sampling.pace.words}"] if axis.command_law.velocity_gain else []
    )
    sign = f"{axis.name}: the command has the opposite sign of the law that was stated; it was turned"
    return [*notes, sign] if turned else notes


def compared(axis: Axis) -> bool:
    """Return whether the description states a law of a command that was recorded."""
    law, signals = axis.command_law, axis.signals
    known = law.kind == "force" and law.position_gain is not None
    return known and signals.command is not None and signals.reference is not None


def unit_of_command(axis: Axis) -> str:
    """Return the unit of the recorded command."""
    column = axis.signals.command
    return (column.unit if column is not None else None) or "1"


def is_law(evidence: Evidence) -> bool:
    """Return whether a piece of evidence is about a command."""
    return isinstance(evidence, LawEvidence)
