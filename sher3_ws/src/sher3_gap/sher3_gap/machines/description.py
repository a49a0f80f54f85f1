"""What a machine is: a chain of independent axes, or a serial arm; read from a short YAML file.

Lengths in m, angles in rad, forces in N, torques in N m; the unit of each recorded signal is stated beside it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError, model_validator
from sher3_description import FileError, read_yaml

from sher3_gap.machines.errors import MachineError

UNITS: Mapping[str, float] = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": math.pi / 180.0,
    "rev": 2.0 * math.pi,
    "m/s": 1.0,
    "mm/s": 1e-3,
    "rad/s": 1.0,
    "deg/s": math.pi / 180.0,
    "rpm": math.pi / 30.0,
    "N": 1.0,
    "kN": 1e3,
    "N*m": 1.0,
    "mN*m": 1e-3,
    "V": 1.0,
    "mV": 1e-3,
    "A": 1.0,
    "mA": 1e-3,
    "1": 1.0,
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "ns": 1e-9,
}
"""Unit -> factor to SI."""


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Column(_Model):
    """A recorded signal.

    `column` names it in the data (`table/name` in a folder), `index` picks an entry of a list or matrix;
    `factor` turns its SI unit into what it stands for (N m per A of a current).
    """

    column: str
    unit: str
    factor: float = 1.0
    index: int | None = None

    @model_validator(mode="after")
    def _known(self) -> Column:
        if self.unit not in UNITS:
            raise ValueError(f"unit {self.unit!r} is not known; units are {', '.join(UNITS)}")
        return self

    @property
    def scale(self) -> float:
        """Factor to SI."""
        return self.factor * UNITS[self.unit]


class Signals(_Model):
    """Recorded signals of an axis; `position` must be there."""

    position: Column
    reference: Column | None = None
    command: Column | None = None
    effort: Column | None = None
    load: Column | None = Field(default=None, description="position of a second encoder at the load")


class CommandLaw(_Model):
    """How the axis is driven.

    Attributes:
        kind: `force`: command times `gain` is the force; `position`: a servo that takes the reference, its force not
            recorded; `none`: free.
        gain: N (or N m) per unit of the command.
        position_gain, velocity_gain: command = position_gain * (reference - q) - velocity_gain * v, where known.
        limit: largest command, where known.
        held: the command acts from its stamp to the next one; else it is the force at its stamp.
        goal: constant reference, where none was recorded.
    """

    kind: Literal["force", "position", "none"]
    gain: float = 1.0
    position_gain: float | None = None
    velocity_gain: float = 0.0
    limit: float | None = Field(default=None, gt=0.0)
    held: bool = False
    goal: float | None = None


class Gravity(_Model):
    """Weight on an axis, N or N m: `constant` + `arm` * sin(q - hanging); `hanging` is where it hangs down, rad."""

    constant: float = 0.0
    arm: float = 0.0
    hanging: float = 0.0


class Axis(_Model):
    """One axis: its nominal constants and what was recorded of it.

    Attributes:
        mass: kg or kg m^2; `unknown`: identified from the data; None: the force balance is not looked at.
        lead: travel per motor revolution; unknown: no period can be named.
        range: positions the axis can reach: finds unit slips.
    """

    name: str = Field(min_length=1)
    motion: Literal["linear", "rotary"]
    signals: Signals
    command_law: CommandLaw
    mass: Annotated[float, Field(gt=0.0)] | Literal["unknown"] | None = None
    viscous: float = Field(default=0.0, ge=0.0)
    gravity: Gravity = Gravity()
    encoder_resolution: float = Field(gt=0.0)
    effort_resolution: float = Field(default=0.0, ge=0.0)
    lead: float | None = Field(default=None, gt=0.0)
    range: tuple[float, float] | None = None

    @model_validator(mode="after")
    def _complete(self) -> Axis:
        law, signals = self.command_law, self.signals
        if law.kind == "position" and signals.reference is None:
            raise ValueError(f"axis {self.name}: a position servo needs its recorded reference")
        if law.kind == "force" and signals.command is None and signals.effort is None:
            raise ValueError(f"axis {self.name}: a force-driven axis needs its recorded command or effort")
        return self


class Clock(_Model):
    """The time column, of the same name in every table; `rate` in Hz where no time was recorded."""

    column: str | None = None
    unit: Literal["s", "ms", "us", "ns"] = "s"
    rate: float | None = Field(default=None, gt=0.0)

    @model_validator(mode="after")
    def _either(self) -> Clock:
        if (self.column is None) == (self.rate is None):
            raise ValueError("state either the time column or the rate")
        return self


class AxesMachine(_Model):
    """A chain of axes, each moved by its own drive."""

    kind: Literal["axes"]
    name: str
    time: Clock
    axes: tuple[Axis, ...] = Field(min_length=1)
    repeats: bool = Field(default=False, description="the data files are repeats of one motion")

    @model_validator(mode="after")
    def _distinct(self) -> AxesMachine:
        names = [a.name for a in self.axes]
        if len(set(names)) < len(names):
            raise ValueError(f"axis names repeat: {', '.join(names)}")
        return self


class Joint(_Model):
    """Row of a modified (Craig) Denavit-Hartenberg table; theta = q + offset."""

    name: str
    a: float
    d: float
    alpha: float
    offset: float = 0.0


class ArmMachine(_Model):
    """A serial arm with tip poses measured from outside; a DH table, or a URDF with its base and tip link.

    Attributes:
        joint_positions: (n, joints) of a table; `poses`: (n, 4, 4) of the measured body in the measuring frame.
        noise: standard deviation of a measured position, m; `noise_rotation`: of an
            orientation, rad; None: orientations only find the frames, positions are judged.
        tip: from the last DH frame to the flange along z, m.
    """

    kind: Literal["arm"]
    name: str
    joint_positions: Column
    poses: Column
    noise: float = Field(gt=0.0)
    noise_rotation: float | None = Field(default=None, gt=0.0)
    joints: tuple[Joint, ...] = ()
    tip: float = 0.0
    urdf: Path | None = None
    base_link: str = ""
    tip_link: str = ""

    @model_validator(mode="after")
    def _either(self) -> ArmMachine:
        if bool(self.joints) == (self.urdf is not None):
            raise ValueError("state either `joints` (DH table) or `urdf`")
        return self


Machine = Annotated[AxesMachine | ArmMachine, Field(discriminator="kind")]


def load_machine(path: Path) -> AxesMachine | ArmMachine:
    """Read a description.

    Raises:
        MachineError: the file cannot be read, or a field is wrong; the error names the field.
    """
    try:
        data = read_yaml(path)
    except FileError as error:
        raise MachineError(f"{path}: cannot be read", value=str(error), remedy="give a YAML description") from error
    try:
        return TypeAdapter(Machine).validate_python(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        raise MachineError(
            f"{path}: {place}: {first['msg']}", value=repr(first["input"])[:80], remedy="see docs/real-data.md"
        ) from error
