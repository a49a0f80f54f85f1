"""What the live view knows of the robot at one moment, and how it says it; plain data, without ROS and browser."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_common import Sher3Error, parse_json
from sher3_description import Robot

TOPICS = (
    "measured_js",
    "setpoint_js",
    "drives/setpoint_jv",
    "drives/measured_js",
    "measured_cp",
    "force/measured_cf",
    "pedal/measured",
    "supervisor/status",
    "admittance/status",
    "admittance/settings",
    "motion/settings",
    "motion/status",
    "diagnostics",
)
"""What the view listens to."""
REFUSING = ("supervisor/status", "motion/status", "admittance/status")
"""Statuses that tell a refused command."""
STALE = 0.5
"""Age [s] from which the newest joint sample is called old."""
MARKS = re.compile(r"([^\w\s.,;:/%()=+-])")
"""What may mean something in Markdown, HTML or MDX."""
CAPS = {"near_tissue": "near_speed", "free": "free_speed"}
"""The setting that holds the speed cap of a regime; the bench has none."""


@dataclass
class Snapshot:
    """The newest sample of each topic.

    Attributes:
        samples: by topic; a topic that has not been heard is absent.
        speed: of the tip [m/s], from the last two poses.
        lost: cycles that each node has lost since it began.
    """

    samples: dict[str, Any]
    speed: float = 0.0
    lost: dict[str, int] = field(default_factory=dict)

    @classmethod
    def empty(cls) -> Snapshot:
        """Return the snapshot of a robot that has not been heard yet."""
        return cls({})

    def take(self, newest: Mapping[str, Callable[[], Any]]) -> None:
        """Take what has come on each topic since the last call."""
        for topic, take in newest.items():
            sample = take()
            if sample is None:
                continue
            before = self.samples.get(topic)
            if topic == "measured_cp" and before is not None and sample.stamp > before.stamp:
                travel = math.dist(sample.position, before.position)
                self.speed = travel / ((sample.stamp - before.stamp) * 1e-9)
            if topic == "diagnostics":
                self.lost.update(lost_cycles(sample))
            self.samples[topic] = sample

    @property
    def position(self) -> tuple[float, ...] | None:
        """Actuator positions (5,), None before the first sample or where they are not finite."""
        sample = self.samples.get("measured_js")
        if sample is None or sample.position is None or not all(map(math.isfinite, sample.position)):
            return None
        return sample.position

    @property
    def force(self) -> NDArray[np.float64]:
        """Force on the tip (3,) [N] in {b}, less the bias of the tare; {f} is parallel to {t}."""
        wrench, pose = self.samples.get("force/measured_cf"), self.samples.get("measured_cp")
        if wrench is None or pose is None:
            return np.zeros(3)
        bias = self.status("admittance/settings").get("live", {}).get("bias", (0.0,) * 6)
        return rotated(pose.orientation, np.subtract(wrench.wrench[:3], bias[:3]))

    @property
    def remote_centre(self) -> tuple[float, ...] | None:
        """Point (3,) [m] in {b}, or None."""
        centre = self.status("motion/settings").get("rcm")
        return None if centre is None else tuple(centre[:3])

    @property
    def pedal(self) -> float:
        """Travel of the pedal, 0 to 1."""
        sample = self.samples.get("pedal/measured")
        return sample.axes[0] if sample is not None and sample.axes else 0.0

    @property
    def cap(self) -> float:
        """Speed cap of the regime in force [m/s], infinite on the bench."""
        settings = self.status("motion/settings")
        key = CAPS.get(str(settings.get("regime")))
        return float(settings["settings"][key]) if key else math.inf

    def tracking(self) -> tuple[str, tuple[float, ...]] | None:
        """Return which error, `position` or `velocity`, and its value (5,) [m, rad] or [m/s, rad/s]; None if unknown.

        The position in position modes, that is while set-points come with the measurement; else the velocity.
        """
        wanted, measured = self.samples.get("setpoint_js"), self.samples.get("measured_js")
        if wanted and measured and wanted.position and measured.position and self._together(wanted, measured):
            return "position", tuple(np.subtract(wanted.position, measured.position))
        wanted, measured = self.samples.get("drives/setpoint_jv"), self.samples.get("drives/measured_js")
        if wanted and measured and wanted.velocity and measured.velocity:
            return "velocity", tuple(np.subtract(wanted.velocity, measured.velocity))
        return None

    @staticmethod
    def _together(a: Any, b: Any) -> bool:
        """Whether two samples are less than a tenth of a second apart."""
        return abs(a.stamp - b.stamp) < 100_000_000

    def status(self, topic: str) -> dict[str, Any]:
        """Return the object of a status topic, empty where there is none."""
        sample = self.samples.get(topic)
        try:
            data = parse_json(sample.text) if sample is not None else {}
        except Sher3Error:
            return {}
        return data if isinstance(data, dict) else {}

    def refusals(self) -> list[str]:
        """Return what was refused last and is not settled yet: by the supervisor, the motion and the law."""
        found = [self.status(topic).get("refused") for topic in REFUSING]
        return [str(refused.get("text") or refused) for refused in found if isinstance(refused, dict)]

    def text(self, robot: Robot, now: int) -> str:
        """Return what the side panel says, as Markdown; `now` is the time [ns]."""
        joints = self.samples.get("measured_js")
        if joints is None:
            return "### Waiting for the robot\nStart it with `sher3 up`."
        supervisor, law = self.status("supervisor/status"), self.status("admittance/status")
        age = (now - joints.stamp) * 1e-9
        cap = "no cap" if math.isinf(self.cap) else f"cap {self.cap * 1e3:g}"
        state = supervisor.get("state", "state unknown")
        why = law.get("text", "") if state == "ENABLED" else f"since {supervisor.get('reason', 'not known')}"
        fault = supervisor.get("first_fault")
        lines = [
            f"### {plain(state)}",
            f"**{plain(fault_text(fault))}**" if isinstance(fault, dict) else plain(why),
            *([f"\n**The joints are {age:.1f} s old.**"] if age > STALE else []),
            *(f"\nRefused: {plain(text)}" for text in self.refusals()),
            "",
            "| | |\n|:--|--:|",
            f"| Tip speed | {self.speed * 1e3:.2f} mm/s, {cap} |",
            f"| Force | {float(np.linalg.norm(self.force)):.2f} N |",
            f"| Pedal | {self.pedal:.0%} |",
            f"| Cycles lost | {sum(self.lost.values())} |",
            "",
        ]
        return "\n".join([*lines, *self._axes(robot)])

    def _axes(self, robot: Robot) -> list[str]:
        """Return the table of the axes: position, share of the travel, tracking error."""
        found = self.tracking()
        kind, errors = found or ("position", (math.nan,) * 5)
        rows = [f"| axis | position | travel | {kind} error |", "|:--|--:|--:|--:|"]
        for actuator, q, error in zip(robot.actuators, self.position or (math.nan,) * 5, errors, strict=True):
            share = (q - actuator.limits.lower) / (actuator.limits.upper - actuator.limits.lower)
            per = "" if kind == "position" else "/s"
            if actuator.kind == "revolute":
                shown, small = f"{math.degrees(q):.3f}°", f"{error * 1e3:.2f} mrad{per}"
            else:
                shown, small = f"{q * 1e3:.3f} mm", f"{error * 1e6:.1f} µm{per}"
            if found is None:
                small = "not known"
            rows.append(f"| {actuator.name} | {shown} | {share:.0%} | {small} |")
        return rows


def rotated(orientation: Sequence[float], vector: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a vector (3,) turned by a quaternion (x, y, z, w): v + 2 u x (u x v + w v) with unit u, w.

    By hand: `scipy.spatial` takes a quarter of the processor time in which `sher3 up` imports what it needs.
    """
    *axis, w = np.divide(orientation, np.linalg.norm(orientation))
    return vector + 2.0 * np.cross(axis, np.cross(axis, vector) + w * vector)


def plain(text: Any) -> str:
    """Return a text that came on a topic so that Markdown shows it as it is: it may be a stranger's."""
    return MARKS.sub(r"\\\1", " ".join(str(text).split()))


def lost_cycles(sample: Any) -> dict[str, int]:
    """Return the lost cycles that a diagnostic of a node tells, by node; empty for other diagnostics."""
    values = dict(sample.values)
    text = values.get("lost_cycles", "")
    return {sample.name: int(text)} if text.isdigit() else {}


def fault_text(fault: dict[str, Any]) -> str:
    """Return code, source, value and limit of a fault; a source that is a sentence of the driver has them in it."""
    text = f"{fault.get('code')} {fault.get('source', '')}".strip()
    value, limit, unit = (fault.get(key) for key in ("value", "limit", "unit"))
    if "(limit" in text or not isinstance(value, float | int) or not isinstance(limit, float | int):
        return text
    return f"{text}: {value:.4g} {unit}, limit {limit:.4g} {unit}"
