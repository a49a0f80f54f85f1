"""A verdict written into a model: what was changed, what the target cannot express, and the text of the model."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from xml.etree.ElementTree import Element

from sher3_chain.manipulator.description import BEHIND
from sher3_diagnosis.verdict import Cause, Identified, Noise, Verdict
from sher3_effects.page import CONSTANTS

from sher3_export.changes import Change, NotExpressed, changes_of, identified_changes, in_words, noise_changes
from sher3_export.errors import ExportError
from sher3_export.targets.configuration import Configuration
from sher3_export.targets.isaac import Isaac, IsaacLab
from sher3_export.targets.mjcf.model import Mjcf
from sher3_export.targets.mjcf.whole import read_mjcf
from sher3_export.targets.mjlab import Mjlab
from sher3_export.targets.plain import Plain
from sher3_export.targets.ros2_control import Ros2Control
from sher3_export.targets.sdf import Sdf
from sher3_export.targets.target import Target, XmlTarget
from sher3_export.targets.urdf import Urdf
from sher3_export.xml_file import read_xml

Motors = Mapping[str, Mapping[str, float]]
"""Motor, by the joint of its name -> joint of the model -> travel of the motor per travel of the joint."""
TARGETS: Mapping[str, type[Target]] = {
    kind.name: kind for kind in (Mjcf, Urdf, Sdf, Isaac, IsaacLab, Mjlab, Ros2Control, Plain)
}
"""Name of a target -> how causes are written into it."""


@dataclass(frozen=True)
class Exported:
    """A verdict in a model.

    Attributes:
        text: of the model or configuration.
        applied: constants that were written.
        not_expressed: what the target cannot express.
    """

    text: str
    applied: Sequence[Change]
    not_expressed: Sequence[NotExpressed]


def export(
    verdict: Verdict,
    target: str,
    model: Path | Element | None = None,
    joints: Mapping[str, str] | None = None,
    motors: Motors | None = None,
    own: bool = False,
) -> Exported:
    """Write the causes of a verdict, the inertias it identified and the noise of its readings into a model.

    Args:
        verdict: of any machine.
        target: one of `TARGETS`.
        model: file of the nominal model, or its root element; those in XML are changed in place of being made anew.
        joints: axis of the verdict -> joint of the model, where their names differ.
        motors: how motors that move several joints travel, where the case has a `coupling`.
        own: whether the model has its forces in the unit of the recorded effort, whatever that is.

    Raises:
        ExportError: no such target, the model is needed and missing, it cannot be read or has none of the joints, or
            the case has a `coupling` and `motors` are not stated.
    """
    motors = travels_of(verdict, motors)
    done, text = put(verdict.causes, target, model, joints, motors, verdict.identified, verdict.noise, own)
    return replace(done, text=text(remarks(verdict, done.applied, done.not_expressed)))


def travels_of(verdict: Verdict, motors: Motors | None) -> Motors:
    """Return how motors travel as stated; raises ExportError where the case has a `coupling` and they are not."""
    if motors is None and verdict.causes and any(note.startswith(BEHIND) for note in verdict.notes):
        remedy = "state each motor's travel, as --motor wrist=wrist:1,elbow:0.5; for `coupling` [[1, 0], [0.5, 1]]"
        raise ExportError("causes of motors behind a coupling", value="no --motor", limit="one each", remedy=remedy)
    return motors or {}


def put(
    causes: Sequence[Cause],
    target: str,
    model: Path | Element | None,
    joints: Mapping[str, str] | None,
    motors: Motors | None = None,
    identified: Sequence[Identified] = (),
    noise: Sequence[Noise] = (),
    own: bool = False,
) -> tuple[Exported, Callable[[Sequence[str]], str]]:
    """Write causes, identified inertias and noise into a model; return what was done, and what makes the text.

    Noise of readings is no gap: a target that has no field for it need not say so of every joint.

    Raises:
        ExportError: as `export` does.
    """
    if target not in TARGETS:
        raise ExportError("no such target", value=target, limit=", ".join(TARGETS), remedy="choose one of them")
    changes, not_expressed = changes_of(causes, joints, own)
    changes += identified_changes(identified, joints)
    changes += [x for x in noise_changes(noise, joints) if x.constant in TARGETS[target].fields]
    writer = opened(TARGETS[target], model)
    applied: list[Change] = []
    for change in changes:
        travel = (motors or {}).get(change.joint)
        if reason := writer.apply(change) if travel is None else writer.apply_at_motor(change, travel):
            known = change.constant in CONSTANTS
            constant, value = (change.constant, change.value) if known else ("", None)
            not_expressed.append(NotExpressed(change.effect, change.joint, constant, value, reason))
        else:
            applied.append(change)
    return Exported("", applied, list(dict.fromkeys(not_expressed))), writer.text


def opened(kind: type[Target], model: Path | Element | None) -> Target:
    """Return a writer for a target; raises ExportError where the model it needs is missing or wrong."""
    if issubclass(kind, Configuration):
        return kind(None if model is None else stated_by(model))
    if not issubclass(kind, XmlTarget):
        return kind()
    if model is None:
        remedy = f"give the nominal model with --model FILE.{kind.name}"
        raise ExportError(f"{kind.name} needs a model to write into", value="no --model", remedy=remedy)
    return kind(_root(model, kind.root_tag) if isinstance(model, Path) else model)


def stated_by(model: Path | Element) -> XmlTarget:
    """Return a model that says what joints have, MJCF or URDF; raises ExportError where it is neither."""
    kinds = {kind.root_tag: kind for kind in (Mjcf, Urdf)}
    root = _root(model, "robot" if model.suffix == ".urdf" else "mujoco") if isinstance(model, Path) else model
    return kinds[root.tag](root)


def _root(path: Path, tag: str) -> Element:
    return read_mjcf(path) if tag == Mjcf.root_tag else read_xml(path, tag)


def remarks(verdict: Verdict, applied: Sequence[Change], not_expressed: Sequence[NotExpressed]) -> list[str]:
    """Return what stands in the comment of a file: what was written, what could not be, and what is not known."""
    rivals = [f"{c.effect} on {c.actuator} may as well be {', '.join(c.rivals)}" for c in verdict.causes if c.rivals]
    lines = [f"Causes of a diagnosis with status {verdict.status}, added to the nominal model.", "Written:"]
    lines += [f"  {text}" for text in in_words(applied)] or ["  nothing"]
    lines += ["Not expressed here:", *(f"  {x}" for x in not_expressed)] if not_expressed else []
    return lines + (["Not told apart:", *(f"  {x}" for x in rivals)] if rivals else [])
