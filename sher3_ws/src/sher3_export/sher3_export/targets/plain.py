"""Plain YAML: every constant and every other number of a cause, for a simulator that has no file of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from sher3_common import dump_yaml
from sher3_effects.page import CONSTANTS

from sher3_export.changes import Change
from sher3_export.targets.target import Target


class Plain(Target):
    """`schema: sher3.model/1`, `joints: {NAME: {CONSTANT: {value, low, high, unit, from}}}`."""

    name = "yaml"
    fields: ClassVar[Mapping[str, str]] = dict.fromkeys(CONSTANTS, "its own name")

    def __init__(self) -> None:
        self.joints: dict[str, dict[str, Any]] = {}

    def apply(self, change: Change) -> str:
        """Write a change; every number can be written."""
        entry = {"value": change.value, "low": change.low, "high": change.high, "unit": change.unit}
        self.joints.setdefault(change.joint, {}).setdefault(change.constant, []).append(
            {**entry, "from": change.effect}
        )
        return ""

    def apply_at_motor(self, change: Change, travel: Mapping[str, float]) -> str:
        """Keep a change of a motor, by the motor's own travel."""
        return self.apply(change)

    def text(self, remarks: Sequence[str]) -> str:
        """Return the constants."""
        data = {"schema": "sher3.model/1", "joints": self.joints}
        return "".join(f"# {line}\n" for line in remarks) + dump_yaml(data)
