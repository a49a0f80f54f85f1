"""The kind `arm`: a serial arm in a case folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from sher3_diagnosis.channel import Array
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.tables import Tables

from sher3_static.arm.description import ArmDescription
from sher3_static.arm.kinematics import arm_from_table
from sher3_static.arm.machine import SerialArm
from sher3_static.arm.record import ArmData, arm_data
from sher3_static.arm.urdf import arm_from_urdf


class ArmKind(Kind[ArmDescription, ArmData]):
    """Serial arms; a case stores `joints` and `poses`."""

    name = "arm"
    description = ArmDescription

    def read(self, name: str, tables: Tables, description: ArmDescription) -> ArmData:
        """Check a data file; raises MachineError."""
        return arm_data(name, tables, description)

    def pack(self, run: ArmData) -> Mapping[str, Array]:
        """Return joint positions and poses."""
        return {"joints": run.joints, "poses": run.poses}

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> ArmData:
        """Return the record that a case stores; raises KeyError where an array is missing."""
        return ArmData(name, arrays["joints"], arrays["poses"], notes)

    def machine(self, description: ArmDescription) -> SerialArm:
        """Return the arm; raises MachineError for a URDF that cannot be read or has no such chain."""
        if description.urdf is None:
            arm = arm_from_table(description.joints, description.tip)
        else:
            arm = arm_from_urdf(Path(description.urdf), description.base_link, description.tip_link)
        return SerialArm(arm, description.noise, description.noise_rotation)


KIND = ArmKind()
