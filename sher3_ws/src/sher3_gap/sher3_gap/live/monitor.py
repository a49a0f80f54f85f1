"""The gap while the robot runs: the model beside it, gap over floor per stage and axis, window by window.

Samples of one tick are joined by their stamp; a full window is judged by the residuals of the diagnosis
(`residuals.py`, `exact.py`). With effects given, what the corrected model makes of the same set-points is subtracted,
so that a known effect no longer counts as a gap.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from sher3_bags import Run, RunMetadata, Stream
from sher3_bags.run import stream
from sher3_common.samples import JointSample, WrenchSample
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Channel
from sher3_sim import PlantEffect

from sher3_gap.case.loading import free, signals_of
from sher3_gap.case.ticks import LONGEST_HOLE
from sher3_gap.errors import CaseError
from sher3_gap.nominal_replay import driven_as
from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.law import EXACT, controller_error, transport_error
from sher3_gap.stages.floors import Floors, chatter_floors, resolution_floors
from sher3_gap.stages.geometry import Geometry
from sher3_gap.stages.residuals import (
    Residual,
    Residuals,
    drive_residual,
    motor_residual,
    transmission_residual,
    wrench_residual,
)
from sher3_gap.stages.units import unit_of

TOPICS = ("setpoint_js", "servo_jv", "drives/setpoint_jv", "drives/measured_js", "measured_js", "force/measured_cf")
NEEDED = ("drives/measured_js", "drives/setpoint_jv", "measured_js")
"""Without one of these a tick is not complete."""
WINDOW = 4.0
"""Seconds a gap is taken over."""
HELD = 12.0
"""Seconds that are held for naming a gap."""
WARNING, ERROR = 1.5, 3.0
"""Gap over floor from which a stage is reported as a warning and as an error."""


@dataclass(frozen=True)
class StageStatus:
    """Gap of one stage on one axis over the last window, rms in SI units."""

    stage: str
    actuator: str
    gap: float
    floor: float
    unit: str

    @property
    def ratio(self) -> float:
        """Gap over floor."""
        return self.gap / self.floor

    @property
    def level(self) -> int:
        """0 at the floor, 1 above it, 2 far above it (diagnostic levels)."""
        return int(self.ratio >= WARNING) + int(self.ratio >= ERROR)


@dataclass
class Monitor:
    """Collects samples and judges windows; `feed` each sample, ask `judge` once a second.

    Args:
        robot: the nominal model.
        effects: what the model beside the robot has beyond the nominal one.
        window: seconds a gap is taken over.
    """

    robot: Robot
    effects: Sequence[PlantEffect] = ()
    window: float = WINDOW
    _ticks: dict[int, dict[str, Any]] = field(default_factory=dict)
    _newest: int = 0

    def feed(self, topic: str, sample: JointSample | WrenchSample) -> None:
        """Take a sample of one of `TOPICS`; samples older than two windows, and than `HELD`, are forgotten."""
        self._ticks.setdefault(sample.stamp, {})[topic] = sample
        self._newest = max(self._newest, sample.stamp)
        keep = round(2.0 * self.window / self.robot.control_period)
        keep = max(keep, round(HELD / self.robot.control_period))
        while len(self._ticks) > keep:
            del self._ticks[next(iter(self._ticks))]

    @property
    def held(self) -> int:
        """Number of ticks whose samples are held."""
        return len(self._ticks)

    def judge(self) -> list[StageStatus]:
        """Return gap and floor per stage over the newest window; empty while it is not full or badly broken."""
        run = self._window()
        if run is None:
            return []
        geometry = Geometry(self.robot)
        real = _residuals(run, self.robot, geometry)
        if self.effects and run.reference is not None:
            real = self._less_the_known(run, real)
        floors = resolution_floors(self.robot, run.period)
        chatter = chatter_floors(run, self.robot)
        out = [_status(c, r, floors, chatter) for c, r in sorted(real.items()) if c in floors and r.ok.any()]
        return [*_exact(run, self.robot), *out]

    def _less_the_known(self, run: RunSignals, real: Residuals) -> Residuals:
        """Residuals less those that the effects alone make on the same set-points."""
        twin = driven_as(run, self.robot, effects=list(self.effects))
        assert twin is not None
        known = _residuals(twin, self.robot, Geometry(self.robot))
        return {
            c: Residual(r.values - known[c].values, r.ok, determined=r.determined)
            for c, r in real.items()
            if c in known
        }

    def stretch(self, seconds: float) -> RunSignals | None:
        """Return the newest seconds as a run; None while they are not whole."""
        return self._window(seconds)

    def _window(self, seconds: float | None = None) -> RunSignals | None:
        """Return the newest window as a run; None while it is not full or a hole in it is too long to bridge."""
        period = round(self.robot.control_period * 1e9)
        last = self._last_complete()
        first = last - (round((seconds or self.window) / self.robot.control_period) - 1) * period
        stamps = sorted(s for s in self._ticks if first <= s <= last)
        if not stamps or stamps[0] > first + LONGEST_HOLE * 1e9:
            return None
        run = Run({t: s for t in TOPICS if (s := self._stream(t, stamps)) is not None}, RunMetadata(origin="robot"))
        try:
            signals = signals_of(run, self.robot, f"window at {last}")
        except CaseError:
            return None
        return signals if signals.wrench is None else replace(signals, contact_known=free(signals.wrench, self.robot))

    def _stream(self, topic: str, stamps: list[int]) -> Stream | None:
        """Return what was heard of a topic at the stamps."""
        heard = [(s, self._ticks[s][topic]) for s in stamps if topic in self._ticks[s]]
        if not heard:
            return None
        sample = heard[0][1]
        if isinstance(sample, WrenchSample):
            wrench = np.array([x.wrench for _, x in heard])
            return stream(topic, [s for s, _ in heard], force=wrench[:, :3], torque=wrench[:, 3:])
        names = [n for n in ("position", "velocity", "effort") if getattr(sample, n) is not None]
        columns: dict[str, Any] = {n: np.array([getattr(x, n) for _, x in heard], dtype=float) for n in names}
        return stream(topic, [s for s, _ in heard], **columns)

    def _last_complete(self) -> int:
        """Return the newest stamp at which every needed stream has arrived."""
        return next((s for s in reversed(self._ticks) if all(t in self._ticks[s] for t in NEEDED)), self._newest)


def _residuals(run: RunSignals, robot: Robot, geometry: Geometry) -> Residuals:
    return {
        **drive_residual(run, robot),
        **motor_residual(run, robot, geometry),
        **transmission_residual(run),
        **wrench_residual(run, geometry),
    }


def _status(channel: Channel, residual: Residual, floors: Floors, chatter: Floors) -> StageStatus:
    part = slice(0, 3) if residual.values.shape[1] == 6 else slice(0, 1)
    floor = np.hypot(floors[channel], chatter.get(channel, 0.0))[part]
    gap = float(np.sqrt(np.mean(residual.rms()[part] ** 2)))
    return StageStatus(channel.stage, channel.actuator, gap, float(np.sqrt(np.mean(floor**2))), unit_of(channel))


def _exact(run: RunSignals, robot: Robot) -> list[StageStatus]:
    """Transport and controller, axis by axis; the window's first ticks lack the command before them."""
    out = []
    for stage, error in (("transport", transport_error(run)), ("controller", controller_error(run, robot))):
        if error is None:
            continue
        for i, name in enumerate(ACTUATORS):
            gap = float(np.sqrt(np.mean(error[2:, i] ** 2)))
            top = robot.actuators[i].limits.velocity
            out.append(StageStatus(stage, name, gap, 1e3 * EXACT * top, unit_of(Channel(stage, name))))
    return out
