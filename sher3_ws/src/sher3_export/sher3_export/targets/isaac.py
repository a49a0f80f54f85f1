"""Isaac Lab: a group of actuators for each joint, with the documented fields of its actuator configurations.

Fields are those of `isaaclab.actuators.ActuatorBaseCfg` and its heirs from 2.2 on: `friction`, `dynamic_friction` (N or
N m) and `viscous_friction`, `armature`, `effort_limit_sim`; `DelayedPDActuatorCfg` counts its delay in physics steps.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

from sher3_common import dump_yaml

from sher3_export.changes import Change
from sher3_export.targets.target import Target

STEP = 0.005
"""Physics step, s, in which a delay is counted; the file says so. Set by custom: tasks of Isaac Lab run at 200 Hz."""
FIELDS: Mapping[str, str] = {
    "coulomb": "dynamic_friction",
    "static": "friction",
    "viscous": "viscous_friction",
    "inertia": "armature",
    "limit": "effort_limit_sim",
}
"""Constant -> field that takes it."""
DELAYS = ("delay", "servo_delay")
"""Constants that a group counts in physics steps: it gives a command, or a reference, so many of them late."""
DRIVE = "an actuator configuration states its gains; multiply stiffness and damping by one plus this"


class Isaac(Target):
    """Actuator groups as YAML: `group: {class, joint_names_expr, field: value}`; values add to the nominal ones."""

    name = "isaac"
    fields: ClassVar[Mapping[str, str]] = {**FIELDS, **dict.fromkeys(DELAYS, "min_delay, max_delay")}
    refuses: ClassVar[Mapping[str, str]] = {
        "load_loss": "friction does not follow the load here; that of the mean load was written",
        "stribeck": "static and sliding friction are stated, the speed between them is not",
        "offset": "an actuator has no constant force",
        "weight": "a share of the weight without its inertia belongs to the asset, not to an actuator",
        **dict.fromkeys(("drive", "servo", "servo_position", "servo_velocity"), DRIVE),
        **dict.fromkeys(("cogging", "cogging_periods", "cogging_phase"), "an actuator has no force over its angle"),
        "lag": "an actuator of this kind has no first-order lag",
        "zero": "the zero of a joint belongs to the asset",
        "backlash": "an actuator has no play",
        **dict.fromkeys(
            ("arm", "hanging"), "a weight at an arm is mass and centre of a link, which the verdict does not give"
        ),
        "compliance": "an actuator has no spring behind it",
        **dict.fromkeys(("spring", "rest"), "an actuator has no spring beside it"),
        "link": "the mass of a link belongs to the asset: the event randomize_rigid_body_mass scales it",
        **dict.fromkeys(("payload", "payload_x", "payload_y", "payload_z"), "a payload belongs to the asset"),
        "ratio": "the load encoder is no part of the actuator",
        **dict.fromkeys(("shift_x", "shift_y", "shift_z"), "the place of a joint belongs to the asset"),
    }

    def __init__(self) -> None:
        self.groups: dict[str, dict[str, object]] = {}

    def apply(self, change: Change) -> str:
        """Write a change into the group of its joint; return why it cannot be written, or nothing."""
        if change.over_stiffness:
            return "given in units of the servo's stiffness, which is not known here"
        if change.constant not in self.fields:
            return self.refuses.get(change.constant, "actuator configurations have no field for it")
        group = self.groups.setdefault(
            change.joint, {"class": "isaaclab.actuators.IdealPDActuatorCfg", "joint_names_expr": [change.joint]}
        )
        if change.constant in DELAYS:
            steps = {"min_delay": math.floor(change.value / STEP), "max_delay": math.ceil(change.value / STEP)}
            group |= {"class": "isaaclab.actuators.DelayedPDActuatorCfg", **steps}
            return ""
        name = FIELDS[change.constant]
        before = group.get(name, 0.0)
        assert isinstance(before, float)
        group[name] = change.value if name == "effort_limit_sim" else before + change.value
        return ""

    def text(self, remarks: Sequence[str]) -> str:
        """Return the groups; friction at rest is never below that in motion."""
        for group in self.groups.values():
            sliding = group.get("dynamic_friction")
            if isinstance(sliding, float):
                static = group.get("friction", 0.0)
                group["friction"] = max(static if isinstance(static, float) else 0.0, sliding)
        lines = [
            *remarks,
            "Values add to those of the nominal asset, limits replace them.",
            f"Delays in steps of {STEP} s.",
        ]
        return "".join(f"# {line}\n" for line in lines) + dump_yaml({"actuators": self.groups})
