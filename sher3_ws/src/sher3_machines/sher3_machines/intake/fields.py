"""Fields that descriptions of every kind share: a recorded column with its unit, and the clock."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from sher3_machines.intake.units import UNITS, spelled

VELOCITIES = ("m/s", "cm/s", "mm/s", "rad/s", "deg/s", "rev/s", "rpm")
"""Units of a velocity: a place that was recorded as one is its integral."""
TIME_UNITS: Mapping[str, float] = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}
"""Units of a clock -> s."""
PRESSURES = ("Pa", "kPa", "bar", "MPa", "psi")
"""Units that become a force by the area they act on."""


class Strict(BaseModel):
    """A part of a description: no field that is not known, no number that is not finite."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Description(Strict):
    """What every description says first; each kind of machine extends it.

    Attributes:
        kind: name of the kind of machine.
        name: of the machine, for people.
    """

    kind: str
    name: str

    @model_validator(mode="before")
    @classmethod
    def _each(cls, data: Any) -> Any:
        """Take `column: [a, b, c]` with one unit as a list of columns."""
        if not isinstance(data, dict):
            return data
        lists = {k: x for k, x in data.items() if isinstance(x, dict) and isinstance(x.get("column"), list | tuple)}
        return {**data, **{k: [{**x, "column": name} for name in x["column"]] for k, x in lists.items()}}

    def named_files(self) -> tuple[str, ...]:
        """Return the paths the description gives, as written; a case gives them absolute."""
        return ()


class Column(Strict):
    """A recorded signal.

    Attributes:
        column: its name in the data; `table/name` where a run is a folder of tables.
        unit: of the recorded numbers; left out where the column's header states it, as in `q [mm]`.
        factor: turns the SI value of that unit into what the signal stands for, such as N m per A of a current, or rad
            per count of an encoder.
        index: entry to pick where each sample is a list.
        offset: added to the scaled values, in SI: what the logger counts from, or a bridge's zero.
        override: whether `unit` holds although the column's header says another one.
        signed_by: column whose sign a magnitude takes, or `motion`: the sign of the motion; an effort alone has one.
        late: s after its stamp at which a sample acts, such as the delay that a model states of an actuator.
        within: smallest and largest recorded number that acts, such as the range of a control; beyond, the bound does.
        step: smallest step of the recorded numbers; that of a position is the count of its encoder, in any unit. Of a
            speed that stands for a place it is the step times a period.
        plus: columns that are added to it, each with its own factor: the pressure on the other side of a piston, the
            second motor of a portal.
    """

    column: str
    unit: str | None = None
    factor: float = 1.0
    index: int | None = None
    offset: float = 0.0
    override: bool = False
    signed_by: str | None = None
    late: float = Field(default=0.0, ge=0.0)
    within: tuple[float, float] | None = None
    step: float | None = Field(default=None, gt=0.0)
    plus: tuple[Column, ...] = ()

    @field_validator("unit", mode="before")
    @classmethod
    def _spelled(cls, unit: object) -> object:
        """Take a unit as people write it, such as `N m` or `Nm`."""
        return spelled(unit) if isinstance(unit, str) else unit

    @model_validator(mode="after")
    def _require_known(self) -> Column:
        if self.unit is not None and self.unit not in UNITS:
            raise ValueError(f"unit {self.unit!r} is not known; units are {', '.join(UNITS)}")
        if self.unit == "count" and self.factor == 1.0:
            raise ValueError("a count needs its `factor`: m or rad per count, as 2 pi over the counts of a turn")
        if self.unit in PRESSURES and self.factor == 1.0:
            raise ValueError("a pressure needs its `factor`: the area it acts on, m^2; below zero on the other side")
        if self.override and self.unit is None:
            raise ValueError("`override` needs the `unit` that holds in place of the header's")
        return self

    @property
    def scale(self) -> float:
        """Factor from recorded numbers to SI, where the description states the unit."""
        return self.factor * UNITS[self.unit or "1"]


class Clock(Strict):
    """The time of the samples.

    Attributes:
        column: of the stamps, of the same name in every table.
        unit: of the stamps.
        index: entry of the column that is the time, where each sample is a list.
        override: whether `unit` holds although the column's header says another one.
        rate: samples per second, Hz, where no stamps were recorded.
        offsets: table -> what is added to its stamps, s, where its clock is another one: that of a second bag.
    """

    column: str | None = None
    unit: Literal["s", "ms", "us", "ns", "min", "h"] = "s"
    index: int | None = None
    override: bool = False
    rate: float | None = Field(default=None, gt=0.0)
    offsets: Mapping[str, float] = {}

    @model_validator(mode="after")
    def _either(self) -> Clock:
        if (self.column is None) == (self.rate is None):
            raise ValueError("state either the time column or the rate")
        return self
