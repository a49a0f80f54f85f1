"""What a report shows that only a serial arm in motion knows: its efforts, and its constants joint by joint."""

from __future__ import annotations

import shlex
from collections.abc import Iterable, Mapping, Sequence

from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import Findings
from sher3_diagnosis.report.odds import parameter_text
from sher3_diagnosis.report.summary import shown_parameters, significant
from sher3_diagnosis.reporter import EMPTY, Output, Table
from sher3_diagnosis.verdict import Cause
from sher3_diagnosis.words import place, words

from sher3_chain.chain.reporter import ChainReporter
from sher3_chain.manipulator.evidence import ArmMotionEvidence
from sher3_chain.manipulator.library import joint_pages

OTHER = "other"
HEADS: Mapping[str, Sequence[str]] = {
    "inertia": ("inertia", "link", "payload"),
    "weight": ("weight", "offset", "arm"),
    "Coulomb": ("coulomb", "static", "load_loss", "friction"),
    "viscous": ("viscous",),
    "delay": ("delay", "servo_delay", "lag", "timing"),
    "gain": ("drive", "servo", "servo_position", "servo_velocity", "ratio", "scale"),
    "play": ("backlash", "lost_motion"),
    "spring": ("compliance", "spring"),
    OTHER: (),
}
"""Head of a column -> constants of the equation of motion, and families of what has none, that stand in it."""
NOT_JUDGED = "not judged"


class ManipulatorReporter(ChainReporter[ArmMotionEvidence]):
    """The part of an arm in motion in a report: measured, nominal and corrected effort over time."""

    def __init__(self, model: str, mjcf: bool) -> None:
        """Take the file of the arm, and whether it is one of MuJoCo or a URDF."""
        kind, ending = ("mjcf", "xml") if mjcf else ("urdf", "urdf")
        self.target = f"--to {kind} --model {shlex.quote(model)} --out corrected.{ending}"

    def joints(self, parts: Sequence[ArmMotionEvidence]) -> str:
        """Return the number of joints."""
        return f"{len(parts[0].described.joints)} joints"

    def table(self, diagnosis: Findings[ArmMotionEvidence]) -> Table | None:
        """Return joints by constants; None where no joint was looked at."""
        if not diagnosis.findings or not diagnosis.verdict.causes:
            return None
        evidence = diagnosis.findings[0].evidence
        names = [joint.name for joint in evidence.described.joints]
        return table_of(diagnosis.verdict.causes, joint_pages(), names, evidence.judged)

    def output(self, evidence: ArmMotionEvidence, run: int, channel: Channel) -> Output:
        """Return the effort of a joint."""
        view = evidence.records[evidence.record_of(run)]
        return Output("effort", view.effort[:, view.row(channel.actuator)])


def table_of(causes: Iterable[Cause], library: Iterable[Effect], joints: Sequence[str], judged: Sequence[str]) -> Table:
    """Return the table of an arm: joints in their order, then links that a cause sits on.

    Args:
        causes: of the verdict.
        library: effects, whose pages say which constant a cause sets.
        joints: of the arm.
        judged: those whose force balance was looked at.
    """
    sets = {e.id: getattr(e, "on_axis", {}) for e in library}
    cells: dict[str, dict[str, list[str]]] = {joint: {} for joint in joints}
    for cause in causes:
        head = head_of(cause, sets.get(cause.effect, {}))
        cells.setdefault(cause.actuator, {}).setdefault(head, []).append(cell(cause, sets.get(cause.effect, {})))
    rows = [
        [place(site), *("; ".join(found.get(head, ())) or EMPTY for head in HEADS)]
        if found or site in judged
        else [place(site), *[NOT_JUDGED] * len(HEADS)]
        for site, found in cells.items()
    ]
    return Table(["joint", *HEADS], rows, {place(site) for site, found in cells.items() if found})


def head_of(cause: Cause, sets: Mapping[str, str]) -> str:
    """Return the column of a cause: of the constant that its first parameter sets, else of its family."""
    constant = next((sets[name] for name in cause.parameters if name in sets), cause.family)
    return next((head for head, held in HEADS.items() if constant in held), OTHER)


def cell(cause: Cause, sets: Mapping[str, str]) -> str:
    """Return a cause with what it sets of constants, else its first parameter, with intervals and rivals."""
    parameters = shown_parameters(cause)
    sizes = {n: p for n, p in parameters.items() if significant(p)} or parameters
    names = [n for n in sizes if n in sets] or list(sizes)[:1]
    text, shown = words(cause.effect), []
    for name in names:
        p, label = sizes[name], f"{name.replace('_', ' ')} " * (len(names) > 1)
        shown.append(f"{label}{parameter_text(p)}{'' if significant(p) else ', size not told'}")
    text += f" {', '.join(shown)}" if shown else ""
    text += f" in {cause.condition}" if cause.condition else ""
    return text + (f" or {', '.join(words(r).lower() for r in cause.rivals)}" if cause.rivals else "")
