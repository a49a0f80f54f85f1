"""The nominal and the exported model on the same recorded commands: position error before and after."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

import numpy as np
from sher3_chain.manipulator.machine import Manipulator
from sher3_diagnosis.channel import Array
from sher3_diagnosis.quantify.closure import interval_of
from sher3_diagnosis.verdict import Interval, Verdict
from sher3_machines import open_case
from sher3_machines.thresholds import BLOCKS

from sher3_export.check.engine import Engine, compiled, copied, prepared
from sher3_export.check.model_of import model_of, model_of_arm
from sher3_export.check.recorded import Recorded, recorded
from sher3_export.targets.mjcf.whole import read_mjcf
from sher3_export.writing import Exported, Motors, export
from sher3_export.xml_file import write_xml

LATE = ("delay", "lag", "limit", "servo", "servo_position", "servo_velocity", "servo_delay")
"""Constants that act between command and force."""


@dataclass(frozen=True)
class JointGap:
    """Position error of one joint over windows that start at recorded states.

    Attributes:
        joint: its name.
        before, after: rms of measured less simulated position with the nominal and the exported model.
        unit: of both, m or rad.
        closure: of the mean square.
    """

    joint: str
    before: float
    after: float
    unit: str
    closure: Interval


@dataclass(frozen=True)
class Checked:
    """An exported model with what is left of the gap of every joint."""

    exported: Exported
    gaps: Sequence[JointGap]

    @property
    def worse(self) -> bool:
        """Whether the exported model predicts worse than the nominal one: in the mean square over all joints alike."""
        return float(np.mean([(gap.after / gap.before) ** 2 for gap in self.gaps if gap.before])) > 1.0


def nominal_model(case: Path, model: Path | None) -> tuple[Element, object, Sequence[Any]]:
    """Return the nominal model, the machine and its runs; without a model, one is made of the description.

    Raises:
        MachineError, ExportError: the case cannot be read, or no model can be made of it.
    """
    machine, runs = open_case(case)
    if model is not None:
        return read_mjcf(model), machine, runs
    recorded(machine, [], {}, False)  # refuses another kind of machine
    if isinstance(machine, Manipulator):
        return model_of_arm(Path(machine.described.model)), machine, runs
    return model_of(machine.gather(runs)), machine, runs


def check(
    verdict: Verdict,
    case: Path,
    model: Path | None,
    joints: Mapping[str, str] | None = None,
    motors: Motors | None = None,
) -> Checked:
    """Write a verdict into a model and run both models on the recorded commands of a case.

    Args:
        verdict: of the case.
        case: folder of a chain of axes.
        model: MJCF; None: made of the case's description, with forces and masses in the unit of the recorded effort.
        joints: axis -> joint of the model, where their names differ.
        motors: how motors that move several joints travel, where the case has a `coupling`.

    Raises:
        MachineError, ExportError: see `nominal_model`; motors are not stated; MuJoCo is missing or refuses the model.
    """
    bench = bench_of(verdict, case, model, joints or {}, motors)
    exported, run = (
        export(verdict, "mjcf", copied(root), joints, motors, own=model is None)
        for root in (bench.original, bench.root)
    )
    engines = (bench.nominal, bench.compiled(run.text))
    errors = [[engine.run(record) for record in bench.records] for engine in engines]
    units = {name: track.unit for name, track in bench.records[0].tracks.items()}
    found = [gap_of(n, units[n], *([x[n] for x in error] for error in errors)) for n in bench.joints]
    return Checked(exported, found)


@dataclass(frozen=True)
class Bench:
    """A case and the nominal model it is run in.

    Attributes:
        original: root of the nominal model as it was given.
        root: the same with a time step that divides the period, and a motor on every joint.
        nominal: the same, compiled.
        records: what was recorded.
        joints: names in the model.
    """

    original: Element
    root: Element
    nominal: Engine
    records: Sequence[Recorded]
    joints: Sequence[str]

    def compiled(self, text: str) -> Engine:
        """Return another model, driven as the nominal one is."""
        return compiled(text, self.joints, self.nominal.actuator)


def bench_of(
    verdict: Verdict, case: Path, model: Path | None, joints: Mapping[str, str], motors: Motors | None = None
) -> Bench:
    """Return the case of a verdict on its nominal model; raises as `check` does."""
    original, machine, runs = nominal_model(case, model)
    return bench_on(verdict, original, machine, runs, joints, motors)


def bench_on(
    verdict: Verdict,
    original: Element,
    machine: object,
    runs: Sequence[Any],
    joints: Mapping[str, str],
    motors: Motors | None = None,
) -> Bench:
    """Return the runs of a machine on a nominal model; raises ExportError, MujocoMissing."""
    late = any(c.constant in LATE for c in export(verdict, "yaml", motors=motors).applied)
    records = recorded(machine, runs, joints, late)
    names = list(records[0].tracks)
    root = prepared(original, records[0].period, records[0].tracks)
    return Bench(original, root, compiled(write_xml(root, ["nominal"]), names), records, names)


def gap_of(joint: str, unit: str, before: Sequence[Array], after: Sequence[Array]) -> JointGap:
    """Return the gap of one joint from the errors (windows, samples) of each run under both models."""
    squares = np.column_stack([np.concatenate([np.mean(run**2, axis=1) for run in x]) for x in (before, after)])
    rows = [
        [*part.mean(axis=0) / squares[:, 0].mean(), 0.0] for part in np.array_split(squares, min(BLOCKS, len(squares)))
    ]
    rms = np.sqrt(squares.mean(axis=0))
    return JointGap(joint, float(rms[0]), float(rms[1]), unit, interval_of(np.array(rows)))
