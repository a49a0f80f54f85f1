"""Isaac Lab 3.0: actuator configurations in Python.

Fields are those of `isaaclab.actuators.ActuatorBaseCfg`: `friction` at rest and `dynamic_friction` (N or N m),
`viscous_friction`, `armature`, `actuator_effort_limit`; `DelayedPDActuatorCfg` counts its delay in physics steps.
Stiffness and damping are left to the asset.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from sher3_export.targets.configuration import Configuration
from sher3_export.targets.isaac import DELAYS, Isaac


class IsaacLab(Configuration):
    """`ACTUATORS` of an `ArticulationCfg`."""

    name = "isaaclab"
    version = "Isaac Lab 3.0"
    source = "isaaclab.actuators"
    plain, delayed = "IdealPDActuatorCfg", "DelayedPDActuatorCfg"
    joints = "joint_names_expr=[{!r}]"
    delays = ("min_delay", "max_delay")
    always: ClassVar[Mapping[str, object]] = {"stiffness": None, "damping": None}
    fields: ClassVar[Mapping[str, str]] = {
        "coulomb": "dynamic_friction",
        "static": "friction",
        "viscous": "viscous_friction",
        "inertia": "armature",
        "limit": "actuator_effort_limit",
        **dict.fromkeys(DELAYS, "min_delay, max_delay"),
    }
    refuses = Isaac.refuses

    def finish(self) -> None:
        """Friction at rest is never below that in motion."""
        for group in self.groups.values():
            if "dynamic_friction" in group:
                group["friction"] = max(group.get("friction", 0.0), group["dynamic_friction"])
