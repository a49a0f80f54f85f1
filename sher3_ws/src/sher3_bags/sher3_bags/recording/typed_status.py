"""The statuses as typed messages beside the texts, so that they can be plotted and watched by other people's tools.

The nodes tell each other their statuses as JSON. Nobody on the control loop reads the typed ones, so they are made
here, from the texts, by who records and by `sher3 state`. `typed/operating_state` is CRTK's own message.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from sher3_common import Sher3Error, parse_json
from sher3_common.stamps import SECOND
from sher3_description import NAMESPACE, Qos

from sher3_bags.codec.packed import packed
from sher3_bags.recording.made import Made

OPERATING_STATE = "crtk_msgs/msg/OperatingState"
LATCHED = Qos(durability="transient_local", depth=1)
Values = dict[str, Any]


class TypedStatuses:
    """Makes the typed statuses from the texts of the status topics."""

    def __init__(self) -> None:
        self._busy, self._operating = False, Values()

    def follow(self, topic: str, text: str, now: int) -> list[Made]:
        """Return the typed messages that follow from a text on one of `SOURCES` at `now` [ns].

        A text that is no such JSON has none; the recording keeps it as it came.
        """
        try:
            data = parse_json(text)
            return list(self._made(topic, data, now)) if isinstance(data, dict) else []
        except (Sher3Error, AttributeError, KeyError, TypeError, ValueError):
            return []

    def _made(self, topic: str, data: Mapping[str, Any], now: int) -> Iterator[Made]:
        header = {"stamp": _time(now)}
        kind, values = SOURCES[topic]
        yield _message(topic.replace("/", "_"), f"sher3_msgs/{kind}", {"header": header, **values(data)})
        if topic == "supervisor/status":
            self._operating = {"state": data["state"], "is_homed": bool(data["is_homed"])}
        elif topic == "motion/status":
            self._busy = bool(data["is_busy"])
        else:
            return
        state = {"header": header, "is_busy": self._busy, **self._operating}
        yield _message("operating_state", OPERATING_STATE.replace("/msg/", "/"), state)


def _message(name: str, kind: str, values: Values) -> Made:
    return Made(f"{NAMESPACE}/typed/{name}", kind.replace("/", "/msg/"), LATCHED, packed(kind, values))


def _supervisor(data: Mapping[str, Any]) -> Values:
    kept = {name: data[name] for name in ("state", "reason", "action", "is_homed", "later_faults")}
    fault = data.get("first_fault") or {}
    return {**kept, "since": _time(data["since"]), "first_fault": fault, "refused": _refusal(data)}


def _motion(data: Mapping[str, Any]) -> Values:
    kept = {name: data[name] for name in ("mode", "reason", "text", "limited_by", "is_busy")}
    deviation = data.get("rcm_deviation")
    away = math.nan if deviation is None else float(deviation)
    return {**kept, "since": _time(data["since"]), "rcm_deviation": away, "refused": _refusal(data)}


def _law(data: Mapping[str, Any]) -> Values:
    kept = {name: data[name] for name in ("reason", "text", "drift_exceeded")}
    return {**kept, "since": _time(data["since"]), "refused": _refusal(data)}


def _settings(data: Mapping[str, Any]) -> Values:
    centre = data.get("rcm")
    numbers = dict(_numbers("", {name: data[name] for name in ("live", "settings") if name in data}))
    return {
        "version": data.get("version", data.get("live", {}).get("version", 0)),
        "regime": data.get("regime"),
        "has_remote_centre": centre is not None,
        "remote_centre": dict(zip("xyz", centre or (0.0, 0.0, 0.0), strict=True)),
        "names": list(numbers),
        "values": list(numbers.values()),
    }


SOURCES: dict[str, tuple[str, Callable[[Mapping[str, Any]], Values]]] = {
    "supervisor/status": ("SupervisorStatus", _supervisor),
    "motion/status": ("MotionStatus", _motion),
    "motion/settings": ("Settings", _settings),
    "admittance/status": ("AdmittanceStatus", _law),
    "admittance/settings": ("Settings", _settings),
}
"""Topic of a text, with the type that says the same and how its fields follow."""


def _numbers(prefix: str, data: Any) -> Iterator[tuple[str, float]]:
    """Yield every number of nested settings with its name, dots between the levels."""
    if isinstance(data, Mapping):
        for name, value in data.items():
            yield from _numbers(f"{prefix}.{name}" if prefix else str(name), value)
    elif isinstance(data, list):
        for k, value in enumerate(data):
            yield from _numbers(f"{prefix}.{k}", value)
    elif isinstance(data, int | float):
        yield prefix, float(data)


def _refusal(data: Mapping[str, Any]) -> Values:
    refused = data.get("refused") or {}
    return {"error": refused.get("error"), "text": refused.get("text")}


def _time(stamp: int) -> Values:
    seconds, nanoseconds = divmod(int(stamp), SECOND)
    return {"sec": seconds, "nanosec": nanoseconds}
