"""mjlab 1.6: actuator configurations in Python around the actuators that the MJCF has.

Fields are those of `mjlab.actuator.ActuatorCfg`: `frictionloss`, `viscous_damping`, `armature` replace the joint's, and
`delay_min_lag`, `delay_max_lag` count physics steps.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from sher3_export.targets.configuration import DELAYS, Configuration
from sher3_export.targets.mjcf import Mjcf

MODEL = "it stands in the MJCF that mjlab loads: write it there with --to mjcf"
"""Why a constant is no field of an actuator's configuration."""
FIELDS: Mapping[str, str] = {
    "coulomb": "frictionloss",
    "viscous": "viscous_damping",
    "inertia": "armature",
    **dict.fromkeys(DELAYS, "delay_min_lag, delay_max_lag"),
}
"""Constant -> field that takes it."""


class Mjlab(Configuration):
    """`ACTUATORS` of an `EntityArticulationInfoCfg`."""

    name = "mjlab"
    version = "mjlab 1.6"
    source = "mjlab.actuator"
    plain = delayed = "XmlActuatorCfg"
    joints = "target_names_expr=({!r},)"
    delays = ("delay_min_lag", "delay_max_lag")
    fields = FIELDS
    refuses: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys((name for name in Mjcf.fields if name not in FIELDS), MODEL),
        **Mjcf.refuses,
    }
