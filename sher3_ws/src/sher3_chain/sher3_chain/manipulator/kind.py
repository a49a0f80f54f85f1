"""The kind `manipulator`: a serial arm in motion in a case folder."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.tables import Tables

from sher3_chain.chain.kind import ChainKind
from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.bodies import Bodies, read_bodies
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.draft import draft_arm
from sher3_chain.manipulator.machine import Manipulator
from sher3_chain.manipulator.model import arm_model


class ManipulatorKind(ChainKind[ManipulatorDescription]):
    """Serial arms in motion."""

    name = "manipulator"
    description = ManipulatorDescription

    def read(self, name: str, tables: Tables, description: ManipulatorDescription) -> AxesRun:
        """Bring a data file onto a uniform clock, with forces of servos that were not recorded; raises MachineError."""
        return with_servos(super().read(name, tables, description), description)

    def draft(self, path: Path, tables: Tables, rate: float | None, model: Path | None) -> Draft | None:
        """Draft an arm where its model is given; None without one."""
        return None if model is None else draft_arm(path, model, rate, tables)

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
