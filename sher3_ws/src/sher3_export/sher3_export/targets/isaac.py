"""Isaac Lab: a group of actuators for each joint, with the documented fields of its actuator configurations.

Fields are those of `isaaclab.actuators.ActuatorBaseCfg`: `friction` at rest and `dynamic_friction` (N or N m),
`viscous_friction`, `armature` and a limit, of which 2.2 and 3.0 have other names; `DelayedPDActuatorCfg` counts its
delay in physics steps. Stiffness and damping are left to the asset, but for those of servos that a cause scales.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from sher3_common import dump_yaml

from sher3_export.targets.configuration import DELAYS, OF_GAINS, OF_READINGS, Configuration
from sher3_export.targets.links import INERTIAL
from sher3_export.targets.target import NOT_GIVEN, each


class IsaacLab(Configuration):
    """`ACTUATORS` of an `ArticulationCfg`, in Python."""

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
        **OF_GAINS,
        **OF_READINGS,
    }
    refuses: ClassVar[Mapping[str, str]] = {
        **NOT_GIVEN,
        **each(
            {
                "stribeck": "static and sliding friction are stated, the speed between them is not",
                "offset": "an actuator has no constant force",
                "weight": "a share of the weight without its inertia belongs to the asset, not to an actuator",
                "cogging cogging_periods cogging_phase": "an actuator has no force over its angle",
                "lag": "an actuator of this kind has no first-order lag",
                "zero": "the zero of a joint belongs to the asset",
                "backlash": "an actuator has no play",
                "compliance": "an actuator has no spring behind it",
                "spring rest": "an actuator has no spring beside it",
                " ".join(INERTIAL): "the inertia of a link belongs to the asset: write it into its URDF or MJCF",
                "link": "the mass of a link belongs to the asset: the event randomize_rigid_body_mass scales it",
                "payload payload_x payload_y payload_z": "a payload belongs to the asset",
                "ratio": "the load encoder is no part of the actuator",
                "shift_x shift_y shift_z": "the place of a joint belongs to the asset",
            }
        ),
    }

    def finish(self) -> None:
        """Friction at rest is never below that in motion."""
        for group in self.groups.values():
            if "dynamic_friction" in group:
                group["friction"] = max(group.get("friction", 0.0), group["dynamic_friction"])


class Isaac(IsaacLab):
    """Groups of the version before as YAML: `group: {class, joint_names_expr, field: value}`."""

    name, suffix = "isaac", "yaml"
    version = "Isaac Lab 2.2"
    fields: ClassVar[Mapping[str, str]] = {**IsaacLab.fields, "limit": "effort_limit_sim"}

    def text(self, remarks: Sequence[str]) -> str:
        """Return the groups."""
        self.finish()
        groups = {
            joint: {"class": f"{self.source}.{self._class(group)}", "joint_names_expr": [joint], **group}
            for joint, group in self.groups.items()
        }
        ranges = {joint: {n: list(x) for n, x in found.items()} for joint, found in self.ranges.items() if found}
        head = "".join(f"# {line}\n" for line in self.remarks_on(remarks))
        return head + dump_yaml({"actuators": groups, "ranges": ranges, "noise": self.noise})
