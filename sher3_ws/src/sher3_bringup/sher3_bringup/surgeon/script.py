"""A scripted surgeon: what the hand and the foot do over time, as plain data.

A script is a YAML file of steps; within a step the wrench is constant plus an optional sine, and both wrench and pedal
move from step to step over `ramp` seconds (a raised cosine, so that the force is smooth).
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sher3_common import read_yaml
from sher3_common.vectors import ZERO_WRENCH, Wrench

from sher3_bringup.errors import ConfigurationError

Seconds = Annotated[float, Field(gt=0.0, le=3600.0, allow_inf_nan=False)]
Component = Annotated[float, Field(ge=-20.0, le=20.0, allow_inf_nan=False)]
BoundedWrench = tuple[Component, Component, Component, Component, Component, Component]


class Step(BaseModel):
    """One thing the surgeon does.

    Attributes:
        name: what it is, for the progress line.
        duration: seconds.
        pedal: travel, 0 released to 1 pressed.
        wrench: on the tip in {b}: N, N*m.
        dither: amplitude of a sine added to the wrench.
        frequency: of the sine [Hz].
        ramp: seconds over which pedal and wrench are reached.
        command: CRTK state command sent when the step begins.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: str
    duration: Seconds
    pedal: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    wrench: BoundedWrench = ZERO_WRENCH
    dither: BoundedWrench = ZERO_WRENCH
    frequency: Annotated[float, Field(gt=0.0, le=50.0)] = 1.0
    ramp: Annotated[float, Field(ge=0.0, le=10.0)] = 0.2
    command: Literal["", "enable", "disable", "pause", "resume"] = ""


class Script(BaseModel):
    """The steps of a scripted surgeon, in order."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)

    schema_: Literal["sher3.teleop/1"] = Field(alias="schema")
    steps: Annotated[tuple[Step, ...], Field(min_length=1, max_length=10_000)]

    @property
    def duration(self) -> float:
        """Length of the script [s]."""
        return sum(step.duration for step in self.steps)

    def step_at(self, time: float) -> tuple[int, float]:
        """Return the index of the step at `time` s and the seconds since it began; the last step lasts for ever."""
        for index, step in enumerate(self.steps[:-1]):
            if time < step.duration:
                return index, time
            time -= step.duration
        return len(self.steps) - 1, time

    def at(self, time: float) -> tuple[float, Wrench]:
        """Return pedal travel and wrench on the tip at `time` s."""
        index, since = self.step_at(time)
        step = self.steps[index]
        before = self.steps[index - 1] if index else Step(name="start", duration=1.0)
        share = _smooth(since / step.ramp) if step.ramp else 1.0
        phase = math.sin(2.0 * math.pi * step.frequency * since)
        wrench = tuple(
            (1.0 - share) * old + share * (new + sine * phase)
            for old, new, sine in zip(before.wrench, step.wrench, step.dither, strict=True)
        )
        return (1.0 - share) * before.pedal + share * step.pedal, wrench  # type: ignore[return-value]


def demo_script() -> Path:
    """Return the path of the script of the demo."""
    return Path(__file__).parent / "scripts" / "demo.yaml"


def load_script(path: Path | str) -> Script:
    """Read and validate a script.

    Raises:
        ConfigurationError: a step has an unknown key or a value out of range; FileError: the file cannot be read.
    """
    try:
        return Script.model_validate(read_yaml(path))
    except ValidationError as error:
        first = error.errors()[0]
        where, value = ".".join(map(str, first["loc"])), first.get("input")
        remedy = "see docs/reference/operation.md for the format"
        raise ConfigurationError(f"{path}: {where}: {first['msg']}", value=value, remedy=remedy) from None


def _smooth(share: float) -> float:
    return 0.5 - 0.5 * math.cos(math.pi * min(max(share, 0.0), 1.0))
