"""The robot model: `robot.yaml` as typed, validated, immutable data that mirrors the file path by path."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any, Literal

import yaml
from pydantic import Field, ValidationError, model_validator
from sher3_common.files.text import parse_yaml, read_yaml
from typing_extensions import Self

from sher3_description.actuators import ACTUATORS
from sher3_description.equipment import Actuator, Admittance, ForceSensor, Tracker
from sher3_description.fields import NonNegative, Part, Period
from sher3_description.invalid_robot import InvalidRobot
from sher3_description.mechanism import ArmParameters, DeltaParameters, TiltLinkageParameters, refuse
from sher3_description.tolerances import Tolerances

NOMINAL_ROBOT = Path(__file__).with_name("robot.yaml")


class Robot(Part):
    """All numbers of one robot; `robot.delta.link_length` is the key `link_length` under `delta` of the file.

    `tolerances` are optional: what the robot may deviate by from these numbers. They are no part of the model, so that
    they neither change its digest nor are written where the file does not state them.
    """

    schema_id: Literal["sher3.robot/1"] = Field(alias="schema")
    control_period: Period
    position_gain: NonNegative
    delta: DeltaParameters
    arm: ArmParameters
    tilt_linkage: TiltLinkageParameters
    force_sensor: ForceSensor
    tracker: Tracker
    actuators: tuple[Actuator, Actuator, Actuator, Actuator, Actuator]
    admittance: Admittance
    tolerances: Tolerances = Tolerances()

    @model_validator(mode="before")
    @classmethod
    def _actuators_to_tuple(cls, data: Any) -> Any:
        if isinstance(data, dict) and isinstance(data.get("actuators"), list):
            return {**data, "actuators": tuple(data["actuators"])}
        return data

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        names = tuple(actuator.name for actuator in self.actuators)
        if names != ACTUATORS:
            raise refuse("actuators are out of order", " ".join(names), " ".join(ACTUATORS), "reorder them")
        if self.position_gain * self.control_period >= 1.0:
            limit = f"< 1 / control_period = {1 / self.control_period:.6g}"
            raise refuse("position_gain overshoots in one period [1/s]", self.position_gain, limit, "reduce it")
        self._check_tilt_travel()
        return self

    def _check_tilt_travel(self) -> None:
        """Refuse tilt limits outside the dead points, where coupler and crank are in line (crank angle from {a} x)."""
        crank, coupler, offset = self.tilt_linkage.crank, self.tilt_linkage.coupler, self.tilt_linkage.offset
        at_zero = math.sqrt(coupler**2 - (offset - crank) ** 2)
        for name in ("lower", "upper"):
            travel = getattr(self.actuators[4].limits, name)
            distance = math.hypot(at_zero + travel, offset)
            if at_zero + travel <= 0 or not abs(coupler - crank) < distance < coupler + crank:
                limit = f"|coupler - crank| < slider-to-axis distance {distance:.6g} < coupler + crank"
                remedy = "reduce the tilt travel or change the linkage"
                raise refuse(f"the tilt linkage cannot follow actuators[4].limits.{name} [m]", travel, limit, remedy)

    @classmethod
    def from_dict(cls, data: Mapping[str, Any], source: Path | str = "<data>") -> Self:
        """Validate plain data.

        Raises:
            InvalidRobot: every unknown or missing key, and every value out of its limit, in one error.
        """
        try:
            return cls.model_validate(dict(data))
        except ValidationError as error:
            raise InvalidRobot.from_validation(error, cls, source) from None

    @classmethod
    def from_yaml(cls, text: str, source: Path | str = "<text>") -> Self:
        """Parse and validate the text of a robot file; raises FileError or InvalidRobot."""
        return cls.from_dict(parse_yaml(text, source), source)

    def to_dict(self) -> dict[str, Any]:
        """Return the robot as plain data with the keys of the file in their order."""
        silent = None if "tolerances" in self.model_fields_set else {"tolerances"}
        return self.model_dump(mode="json", by_alias=True, exclude=silent)

    def to_yaml(self) -> str:
        """Return text that `from_yaml` reads back to an equal robot (floats in full precision, no comments)."""
        return yaml.safe_dump(self.to_dict(), sort_keys=False, default_flow_style=None, width=120)

    def digest(self) -> str:
        """Return the SHA-256 of the values, independent of layout and comments (64 hexadecimal digits)."""
        values = {key: value for key, value in self.to_dict().items() if key != "tolerances"}
        return hashlib.sha256(json.dumps(values, sort_keys=True).encode()).hexdigest()

    def replace(self, values: Mapping[str, Any]) -> Self:
        """Return a validated copy with the values at the given paths changed.

        Args:
            values: by path, as in `{"delta.link_length": 0.0641, "actuators[3].viscous": 0.06}`.

        Raises:
            InvalidRobot: an unknown path, or the changed robot is invalid.
        """
        data = self.to_dict()
        for path, value in values.items():
            *parents, last = path.replace("[", ".").replace("]", "").split(".")
            node: Any = data
            try:
                for key in parents:
                    node = node[int(key)] if isinstance(node, list) else node[key]
                index: Any = int(last) if isinstance(node, list) else last
                if isinstance(node, dict) and index not in node:
                    raise KeyError(index)
                node[index] = value
            except (KeyError, IndexError, ValueError, TypeError):
                raise InvalidRobot.unknown_path(path) from None
        return type(self).from_dict(data, "<replace>")


@lru_cache(maxsize=1)
def _nominal() -> Robot:
    return Robot.from_dict(read_yaml(NOMINAL_ROBOT), NOMINAL_ROBOT)


def load_robot(path: Path | str | None = None) -> Robot:
    """Read and validate a robot file; without a path, return the nominal robot.

    Raises:
        FileError: the file is missing, too large or not YAML.
        InvalidRobot: its content is not a valid robot.
    """
    return _nominal() if path is None else Robot.from_dict(read_yaml(path), path)
