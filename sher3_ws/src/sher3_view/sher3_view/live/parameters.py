"""The settings in force as ROS parameters, and which of them a command may change; plain data, without ROS."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

Value = float | str | bool


class Command(NamedTuple):
    """How a parameter is changed: the topic, the text with the value in it, and who answers where.

    Attributes:
        topic: of the command.
        text: with `{}` for the value.
        settings: topic on which a change shows.
        status: topic on which a refusal shows.
    """

    topic: str
    text: str
    settings: str
    status: str


_LAW = ("admittance/settings", "admittance/status")
SETTABLE = {
    "speed_scale": Command("command/admittance", "speed_scale {}", *_LAW),
    "linear_gain": Command("command/admittance", "linear_gain {}", *_LAW),
    "angular_gain": Command("command/admittance", "angular_gain {}", *_LAW),
    "regime": Command("command/regime", "{}", "motion/settings", "motion/status"),
}
"""Parameters that may change while the robot runs: the nodes check every value, as they check any command."""


def parameters_of(law: Mapping[str, Any], motion: Mapping[str, Any]) -> dict[str, Value]:
    """Return the parameters by name from the settings of the law and of the motion node, empty where there are none.

    Live ones have plain names; those fixed at the start bear the name of their part.
    """
    live = law.get("live", {})
    found: dict[str, Value] = {name: float(live[name]) for name in SETTABLE if name in live}
    if "regime" in motion:
        found["regime"] = str(motion["regime"])
    found.update(_flat("law", {k: v for k, v in law.get("settings", {}).items() if k not in ("motion", "supervisor")}))
    found.update(_flat("motion", motion.get("settings", {})))
    return found


def _flat(prefix: str, data: Any) -> Iterator[tuple[str, Value]]:
    if isinstance(data, Mapping):
        for name, value in data.items():
            yield from _flat(f"{prefix}.{name}", value)
    elif isinstance(data, bool | str):
        yield prefix, data
    elif isinstance(data, int | float):
        yield prefix, float(data)
