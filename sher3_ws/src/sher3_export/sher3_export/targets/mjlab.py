"""mjlab 1.6: actuator configurations in Python around the actuators that the MJCF has.

Fields are those of `mjlab.actuator.ActuatorCfg`: `frictionloss`, `viscous_damping`, `armature` replace the joint's, and
`delay_min_lag`, `delay_max_lag` count physics steps. A servo whose gains a cause changes becomes a group of its own,
`BuiltinPositionActuatorCfg`, which puts another `<position>` on the joint.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from sher3_export.targets.configuration import DELAYS, GAINS, OF_GAINS, Configuration
from sher3_export.targets.mjcf import Mjcf

MODEL = "it stands in the MJCF that mjlab loads: write it there with --to mjcf"
"""Why a constant is no field of an actuator's configuration."""
FIELDS: Mapping[str, str] = {
    "coulomb": "frictionloss",
    "viscous": "viscous_damping",
    "inertia": "armature",
    **dict.fromkeys(DELAYS, "delay_min_lag, delay_max_lag"),
    **OF_GAINS,
}
"""Constant -> field that takes it."""
TWICE = "A BuiltinPositionActuatorCfg adds its own <position>: take that of its joint out of the MJCF."


class Mjlab(Configuration):
    """`ACTUATORS` of an `EntityArticulationInfoCfg`."""

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

    def said(self, remarks: Sequence[str]) -> list[str]:
        """Say also where a group stands in place of an actuator of the MJCF."""
        twice = any(self._class(group) == self.servo for group in self.groups.values())
        return [*super().said(remarks), *([TWICE] if twice else [])]

    def finish(self) -> None:
        """State both gains of a servo: its class needs them."""
        for joint, group in self.groups.items():
            if self._class(group) == self.servo:
                known = (self.nominal or {})[joint]
                group |= {name: known.get(name, 0.0) for name in GAINS["servo"] if name not in group}
