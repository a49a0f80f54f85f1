"""What may change while the cooperative mode runs: speed scale, gains and axis lock by command, the bias by a tare.

`command/admittance` carries one parameter as `name value`: `speed_scale 0.5`, `linear_gain 0.002`, `angular_gain 4` or
`axis_lock needle`. Every change makes a new version, and recordings name the version that each tick used.
"""

from __future__ import annotations

import json
import math
from typing import Any, NamedTuple

from sher3_common import parse_json
from sher3_common.vectors import ZERO_WRENCH, Wrench

from sher3_control.errors import SettingsError
from sher3_control.law.axis_lock import AxisLock
from sher3_control.settings import ControlSettings


class LiveParameters(NamedTuple):
    """The parameters in force.

    Attributes:
        version: 0 at the start, one more at each change.
        speed_scale: factor on every velocity [1].
        linear_gain, angular_gain: (m/s)/N and (rad/s)/(N m).
        lock: which part of a twist passes.
        bias: of the force sensor in {f} [N], [N m].
    """

    version: int
    speed_scale: float
    linear_gain: float
    angular_gain: float
    lock: AxisLock
    bias: Wrench


def live_parameters(settings: ControlSettings) -> LiveParameters:
    """Return the parameters at the start: full scale, the gains of the settings, nothing locked, no bias."""
    a = settings.admittance
    return LiveParameters(0, 1.0, a.linear_gain, a.angular_gain, AxisLock.FREE, ZERO_WRENCH)


def apply_command(live: LiveParameters, text: str, settings: ControlSettings) -> LiveParameters:
    """Return the next version of the parameters after the command `name value`.

    Raises:
        SettingsError: unknown name, no number, or out of range.
    """
    name, _, value = text.strip().partition(" ")
    a = settings.admittance
    if name == "axis_lock":
        return live._replace(version=live.version + 1, lock=_lock(value))
    highest = {
        "speed_scale": 1.0,
        "linear_gain": a.linear_gain * a.gain_maximum,
        "angular_gain": a.angular_gain * a.gain_maximum,
    }
    if name not in highest:
        known = ", ".join([*highest, "axis_lock"])
        raise SettingsError("unknown live parameter", value=name, limit=known, remedy="use one of these")
    number = _number(name, value)
    if not 0.0 <= number <= highest[name]:
        raise SettingsError(f"{name} out of range", value=number, limit=(0.0, highest[name]), remedy="stay in range")
    changes: dict[str, Any] = {name: number, "version": live.version + 1}
    return live._replace(**changes)


def with_bias(live: LiveParameters, bias: Wrench) -> LiveParameters:
    """Return the next version with another bias."""
    return live._replace(version=live.version + 1, bias=bias)


def to_json(live: LiveParameters, settings: ControlSettings) -> str:
    """Return parameters and settings as one line of JSON that restores them exactly."""
    return json.dumps({"live": {**live._asdict(), "lock": int(live.lock)}, "settings": settings.model_dump()})


def from_json(text: str) -> tuple[LiveParameters, ControlSettings]:
    """Return the parameters and settings of a text that `to_json` wrote.

    Raises:
        SettingsError: the text is something else.
    """
    try:
        data = parse_json(text)
        live = data["live"]
        lock, bias = AxisLock(live["lock"]), tuple(map(float, live["bias"]))
        if len(bias) != len(ZERO_WRENCH):
            raise ValueError("bias")
        stated: dict[str, Any] = {**live, "lock": lock, "bias": bias}
        return LiveParameters(**stated), ControlSettings.model_validate(data["settings"])
    except (KeyError, TypeError, ValueError) as error:
        raise SettingsError("recorded settings are damaged", value=text[:80], remedy="record the run again") from error


def _lock(value: str) -> AxisLock:
    try:
        return AxisLock[value.strip().upper()]
    except KeyError:
        known = ", ".join(lock.name.lower() for lock in AxisLock)
        raise SettingsError("unknown axis lock", value=value, limit=known, remedy="use one of these") from None


def _number(name: str, value: str) -> float:
    try:
        number = float(value)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise SettingsError(f"{name} needs a finite number", value=value, remedy=f"send `{name} 0.5`")
    return number
