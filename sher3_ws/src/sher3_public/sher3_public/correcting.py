"""The causes of a verdict written into the model that was given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_diagnosis.verdict import Verdict
from sher3_export.changes import in_words
from sher3_export.targets.mjcf.model import Mjcf
from sher3_export.targets.mjcf.whole import whole
from sher3_export.targets.sdf import Sdf
from sher3_export.targets.urdf import Urdf
from sher3_export.writing import export
from sher3_export.xml_file import parse_xml

from sher3_public.errors import InputError
from sher3_public.models import Source

ROOTS = {kind.name: kind.root_tag for kind in (Mjcf, Urdf, Sdf)}
"""Targets that are written into a model of their own, and the root of their XML; no diagnosis is given an SDF."""


@dataclass(frozen=True)
class Corrected:
    """A model with the causes in it.

    Attributes:
        text: of the model.
        written: what was changed, one sentence each.
        not_expressed: what the model's format cannot say, one sentence each.
    """

    text: str
    written: Sequence[str]
    not_expressed: Sequence[str]

    def __str__(self) -> str:
        return "\n".join([*self.written, *(f"not expressed: {x}" for x in self.not_expressed)]) or "nothing to correct"


def corrected(verdict: Verdict, source: Source | None, to: str = "") -> Corrected:
    """Return a model with the causes in it; raises InputError, ExportError as `Answer.corrected` does."""
    own = "yaml" if source is None else "urdf" if source.bodies.mujoco is None else "mjcf"
    target = to or own
    root = None
    if target in ROOTS and (source is None or target != own or source.text is None):
        remedy = "give the model as a path, a text or an MjSpec of that format, or use to='yaml'"
        if target == Sdf.name:
            remedy = "write `verdict.to_json()` to a file, and run `sher3 gap export FILE --to sdf --model MODEL.sdf`"
        given = "an MjModel" if source is not None and source.text is None else own
        raise InputError(f"{target} is written into the model that was given", value=given, remedy=remedy)
    if own in ROOTS and source is not None and source.text is not None:
        root = parse_xml(source.text, ROOTS[own])
        root = root if source.bodies.mujoco is None else whole(root, source.path)
    done = export(verdict, target, root)
    return Corrected(done.text, in_words(done.applied), [str(x) for x in done.not_expressed])
