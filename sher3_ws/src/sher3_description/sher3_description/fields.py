"""Field types of the robot model: finite numbers with a sign and a plausible magnitude.

The bounds are far beyond any real instrument of this kind; they catch slips of units (mm for m, deg for rad) and
numbers that no robot can have, with which the arithmetic behind them would overflow or never end.
"""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, Strict


def _number(value: Any) -> Any:
    """Accept text that is a number: YAML 1.1 reads `1e-6`, without a point, as text."""
    if isinstance(value, str):
        try:
            return float(value)
        except ValueError:
            return value
    return value


def _sequence(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


Number = Annotated[float, BeforeValidator(_number), Strict(), Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0.0)]
NonNegative = Annotated[Number, Field(ge=0.0)]
Period = Annotated[Number, Field(ge=1e-4, le=0.1)]
Inertia = Annotated[Number, Field(ge=1e-6, le=1000.0)]
Resolution = Annotated[Number, Field(ge=1e-12, le=0.1)]
Lead = Annotated[Number, Field(ge=1e-6, le=10.0)]
Gain = Annotated[Number, Field(ge=1e-6, le=1e9)]
Load = Annotated[Number, Field(ge=1e-6, le=1e6)]
Rate = Annotated[Number, Field(ge=1e-3, le=1e5)]
Length = Annotated[Number, Field(gt=0.0, le=2.0)]
Coordinate = Annotated[Number, Field(ge=-2.0, le=2.0)]
Angle = Annotated[Number, Field(ge=-6.283185307179587, le=6.283185307179587)]
Mass = Annotated[Number, Field(ge=0.0, le=1000.0)]
Vector = Annotated[tuple[Coordinate, Coordinate, Coordinate], BeforeValidator(_sequence)]
PositiveVector = Annotated[tuple[Positive, Positive, Positive], BeforeValidator(_sequence)]
AngleVector = Annotated[tuple[Angle, Angle, Angle], BeforeValidator(_sequence)]


class Part(BaseModel):
    """Base of every part of the robot model: immutable, with no key beyond those declared."""

    model_config = ConfigDict(frozen=True, extra="forbid", populate_by_name=True)
