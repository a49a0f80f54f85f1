"""mjlab 1.6: actuator configurations in Python around the actuators that the MJCF has, and what its joints are given.

`XmlActuatorCfg` takes `frictionloss`, `viscous_damping`, `armature` and leaves the joint as the MJCF has it, so these
are written into the `MjSpec` that mjlab asks for; `delay_min_lag`, `delay_max_lag` count physics steps. A servo whose
gains a cause changes becomes a group of its own, `BuiltinPositionActuatorCfg`, which puts another `<position>` on the
joint.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from sher3_export.targets.configuration import DELAYS, GAINS, OF_GAINS, OF_READINGS, Configuration
from sher3_export.targets.mjcf.model import Mjcf
from sher3_export.targets.target import XmlTarget

MODEL = "it stands in the MJCF that mjlab loads: write it there with --to mjcf"
"""Why a constant is no field of an actuator's configuration."""
OF_JOINT: Mapping[str, str] = {"coulomb": "frictionloss", "viscous": "viscous_damping", "inertia": "armature"}
"""Constant of a joint -> what mjlab calls it."""
FIELDS: Mapping[str, str] = {
    **OF_JOINT,
    **dict.fromkeys(DELAYS, "delay_min_lag, delay_max_lag"),
    **OF_GAINS,
    **OF_READINGS,
}
"""Constant -> field that takes it."""
WRITTEN = '''
JOINTS = {joints}


def with_joints(spec):
    """Return an MjSpec whose joints have JOINTS, for `EntityCfg(spec_fn=...)`: actuators leave them as they are."""
    for name, fields in JOINTS.items():
        for field, value in fields.items():
            if field == "viscous_damping":
                spec.joint(name).damping[0] = value
            else:
                setattr(spec.joint(name), field, value)
    return spec
'''
"""What a file has beside its actuators; MuJoCo's damping is a row of which the first number is the linear one."""
TWICE = "A BuiltinPositionActuatorCfg adds its own <position>: take that of its joint out of the MJCF."


class Mjlab(Configuration):
    """`ACTUATORS` of an `EntityArticulationInfoCfg`, and `with_joints` for the `spec_fn` of an `EntityCfg`."""

    name = "mjlab"
    version = "mjlab 1.6"
    source = "mjlab.actuator"
    plain = delayed = "XmlActuatorCfg"
    joints = "target_names_expr=({!r},)"
    servo = "BuiltinPositionActuatorCfg"
    delays = ("delay_min_lag", "delay_max_lag")
    fields = FIELDS
    refuses: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys((name for name in Mjcf.fields if name not in FIELDS), MODEL),
        **Mjcf.refuses,
    }

    def __init__(self, model: XmlTarget | None = None) -> None:
        super().__init__(model)
        self.of_joints: dict[str, dict[str, float]] = {}

    def remarks_on(self, remarks: Sequence[str]) -> list[str]:
        """Say also where a group stands in place of an actuator of the MJCF."""
        twice = any(self._class(group) == self.servo for group in self.groups.values())
        return [*super().remarks_on(remarks), *([TWICE] if twice else [])]

    def finish(self) -> None:
        """Take what is of the joints out of their groups; state both gains of a servo, since its class needs them."""
        self.of_joints = {
            joint: {name: group.pop(name) for name in OF_JOINT.values() if name in group}
            for joint, group in self.groups.items()
        }
        for joint, group in self.groups.items():
            if self._class(group) == self.servo:
                known = (self.nominal or {})[joint]
                group |= {name: known.get(name, 0.0) for name in GAINS["servo"] if name not in group}

    def beside(self) -> str:
        """Return what the joints are given, and what writes it into a specification."""
        said = "".join(f"    {joint!r}: {fields!r},\n" for joint, fields in self.of_joints.items() if fields)
        return WRITTEN.replace("{joints}", f"{{\n{said}}}" if said else "{}")
