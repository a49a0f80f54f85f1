"""The kind `manipulator`: a serial arm in motion in a case folder."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.draft import Draft
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.tables import Tables

from sher3_chain.axes.kind import packed, unpacked
from sher3_chain.axes.record import AxesRun, axes_run, parts_of_record
from sher3_chain.manipulator.bodies import Bodies, read_bodies
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.draft import draft_arm
from sher3_chain.manipulator.machine import Manipulator
from sher3_chain.manipulator.model import arm_model


class ManipulatorKind(Kind[ManipulatorDescription, AxesRun]):
    """Serial arms in motion; a case stores `period` and an array `JOINT/SIGNAL` for each signal."""

    name = "manipulator"
    description = ManipulatorDescription

    def read(self, name: str, tables: Tables, description: ManipulatorDescription) -> AxesRun:
        """Bring a data file onto a uniform clock, with forces of servos that were not recorded; raises MachineError."""
        return with_servos(axes_run(name, tables, description), description)

    def parts(self, name: str, tables: Tables, description: ManipulatorDescription) -> tuple[dict[str, Tables], str]:
        """Return the parts of a record whose clock has holes or jumps back; repeats stay whole."""
        return ({name: tables}, "") if description.repeats else parts_of_record(name, tables, description)

    def draft(self, path: Path, tables: Tables, rate: float | None, model: Path | None) -> Draft | None:
        """Draft an arm where its model is given; None without one."""
        return None if model is None else draft_arm(path, model, rate, tables)

    def pack(self, run: AxesRun) -> Mapping[str, Array]:
        """Return the period and every signal."""
        return packed(run)

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> AxesRun:
        """Return the run that a case stores; raises KeyError without a period."""
        return unpacked(name, arrays, notes)

    def machine(self, description: ManipulatorDescription) -> Manipulator:
        """Return the arm; raises MachineError for a model that cannot be read or has no such joint."""
        return arm_of(description, read_bodies(Path(description.model)))


def arm_of(description: ManipulatorDescription, bodies: Bodies) -> Manipulator:
    """Return the arm of a description and a model; raises MachineError for a model that has no such joint."""
    stated = [j.name for j in description.joints if "viscous" in j.model_fields_set]
    return Manipulator(
        description, arm_model(bodies, [j.name for j in description.joints], description.gravity, stated)
    )


def with_servos(run: AxesRun, description: ManipulatorDescription) -> AxesRun:
    """Return a run with the force of every servo whose effort was not recorded, by its stated law."""
    signals, notes = dict(run.signals), list(run.notes)
    for joint in description.joints:
        found, law = signals[joint.name], joint.command_law
        if not joint.follows or {"effort", "command"} & found.keys():
            continue
        speed = np.gradient(found["position"], run.period)
        force = (law.position_gain or 0.0) * (found["reference"] - found["position"]) - law.velocity_gain * speed
        limit = math.inf if law.limit is None else law.limit
        signals[joint.name] = {**found, "effort": np.clip(force, -limit, limit)}
        notes.append(f"{run.name}: {joint.name}: effort is that of its servo's law; none was recorded")
    return replace(run, signals=signals, notes=notes)


KIND = ManipulatorKind()
