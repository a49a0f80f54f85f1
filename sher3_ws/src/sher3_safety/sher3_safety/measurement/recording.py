"""What a recorded run shows of its faults: detection, rest, travel of the tip, and motion after the recovery.

Everything is read from the bag. The tip is where forward kinematics puts the plant's true joint positions, recorded at
every step (`mock/true_js`); a fault's onset and end are its requests on `mock/fault`.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags.run import Run
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_description import Robot
from sher3_faults.kinds import OK
from sher3_kinematics.kernel import kernel_parameters
from sher3_kinematics.kernel.batch import tip_pose_batch

from sher3_safety.errors import MeasurementError

STANDS = 0.02
"""The tip is at rest from when it stays this close to its last place, as a share of the budget: 0.5 um of 25 um."""
BEFORE = 0.020
"""The speed before a fault is the mean over the last 20 ms, ten ticks at 500 Hz [s]."""
INTENDED = frozenset({"MOVING", "PEDAL_RELEASED", "NOT_REARMED", "NOT_ENABLED", "NOT_OWNER"})
SILENT = "NOT_ENABLED"
"""Reason of the law when it no longer hears that the robot is enabled."""
REPORTS = ("admittance/status", "motion/status")


@dataclass(frozen=True)
class Outcome:
    """What the robot did after one fault.

    Attributes:
        label: of the request.
        speed: of the tip before, m/s.
        reason: first reported reason to stop, empty when nobody reported one.
        detection: from the onset to that report or to the first fall of the executed demand, s.
        stop: from the onset until the tip is at rest, s; None: it did not come to rest.
        travel: largest distance of the tip from where it was at the onset, m.
        excess: largest distance of the tip from its undisturbed path, m: straight on at the speed before, with a stop
            anywhere on it; of a robot that a hand leads off from rest, along the hand.
        fault: the operating state became FAULT.
        alone: how far the tip is, when the pedal is released, from where the observation ended, m; between the two the
            hand lets go, and takes hold again.
        resumed: motion after release-then-press, m.
        to_end: at the onset, of the axis that is nearest to an end of its travel, as a share of the travel.
        operating: operating state when the fault set in, empty where the bag does not tell.
        braking: travel of the tip after the first report, m.
        faulted: from the onset to FAULT, s; None: never.
        fault_reason: of the FAULT.
    """

    label: str
    speed: float
    reason: str
    detection: float | None
    stop: float | None
    travel: float
    excess: float
    fault: bool
    alone: float
    resumed: float
    to_end: float = 0.5
    operating: str = OperatingState.ENABLED.value
    braking: float = 0.0
    faulted: float | None = None
    fault_reason: str = ""

    @property
    def tripped(self) -> bool:
        """Whether anything gave a reason to stop."""
        return bool(self.reason)

    def to_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return asdict(self)


class Recording:
    """A bag of injected faults.

    Args:
        run: with `mock/true_js`, `mock/fault`, the status topics and the pedal.
        robot: for the kinematics.
        period: step of the plant in stepped time, s; None: the stamps tell (wall time).

    Raises:
        MeasurementError: the truth was not recorded.
    """

    def __init__(self, run: Run, robot: Robot, period: float | None = None) -> None:
        if "mock/true_js" not in run or not len(run["mock/true_js"]):
            raise MeasurementError("mock/true_js is missing", remedy="send a request on mock/fault before the fault")
        truth = run["mock/true_js"]
        self._run, self._stamp = run, truth.stamp
        self._tip = tip_pose_batch(kernel_parameters(robot), np.ascontiguousarray(truth.position))[1]
        ends = np.array([(a.limits.lower, a.limits.upper) for a in robot.actuators])
        room = np.minimum(truth.position - ends[:, 0], ends[:, 1] - truth.position)
        self._to_end = (room / (ends[:, 1] - ends[:, 0])).min(axis=1)
        self._demand = np.abs(truth.velocity)
        rows = np.arange(len(self._stamp))
        self._stepped = period is not None
        self._time = rows * period if period is not None else (self._stamp - self._stamp[0]) * 1e-9
        # Not being enabled is a reason of its own only where no other one comes with it.
        self._events = sorted(self._reported(), key=lambda event: (event[0], event[1] == SILENT))

    def _reported(self) -> list[tuple[int, str, bool]]:
        """Return (log time, reason, is FAULT) of every report of a reason to stop."""
        found = []
        for topic in REPORTS:
            for stamp, data in self._texts(topic):
                if data.get("reason") not in INTENDED - {SILENT}:
                    found.append((stamp, str(data.get("reason")), False))
        for stamp, data in self._texts("supervisor/status"):
            state = data.get("state")
            asked = data.get("reason") == StateCommand.PAUSE
            if state == OperatingState.FAULT or (state == OperatingState.PAUSED and not asked):
                first = data.get("first_fault") or data
                found.append((stamp, str(first.get("code") or first.get("reason")), state == OperatingState.FAULT))
        return found

    def _texts(self, topic: str) -> list[tuple[int, dict[str, Any]]]:
        if topic not in self._run:
            return []
        stream = self._run[topic]
        return [(int(s), json.loads(text)) for s, text in zip(stream.stamp, stream.data, strict=True)]

    def outcomes(
        self, stands: Callable[[str], float], pushed: Callable[[str], bool] = lambda _: False
    ) -> list[Outcome]:
        """Return one outcome for each labelled fault that was begun and ended.

        Args:
            stands: how close to its end the tip must stay to stand, m, by label.
            pushed: whether the way of the tip is that of a hand which leads it off, by label.
        """
        requests = [(stamp, data) for stamp, data in self._texts("mock/fault") if data.get("label")]
        outcomes = []
        for (onset, request), (end, closing) in pairwise(requests):
            if request["fault"] != OK and closing["fault"] == OK and closing["label"] == request["label"]:
                following = next((s for s, data in requests if s > end and data["fault"] != OK), None)
                name = request["label"]
                outcomes.append(self.outcome(name, onset, end, following, stands(name), pushed(name)))
        return outcomes

    def _hand(self, stamp: int) -> NDArray[np.float64]:
        """Return the force of the hand (3,) at a time, N."""
        told = self._run["mock/contact_wrench"]
        force = told.force[max(0, int(np.searchsorted(told.stamp, stamp, side="right")) - 1)]
        return np.asarray(force, dtype=np.float64)

    def _row(self, stamp: int, after: int = 0) -> int:
        """Return the first row at or behind a time; only forwards, so that a clock that jumps does no harm."""
        found = np.nonzero(self._stamp[after:] >= stamp)[0]
        return after + int(found[0]) if len(found) else len(self._stamp) - 1

    def _onset(self, stamp: int) -> int:
        """Return the row at which a fault sets in; in wall time the last row before it: the next may be late."""
        if self._stepped:
            return self._row(stamp)
        return max(0, int(np.searchsorted(self._stamp, stamp, side="right")) - 1)

    def outcome(
        self, label: str, onset: int, end: int, following: int | None, stands: float, pushed: bool = False
    ) -> Outcome:
        """Return the outcome of a fault that was observed from `onset` to `end` [ns of the graph's clock].

        Args:
            label: of the outcome.
            onset: when the fault set in, ns.
            end: of the observation, ns.
            following: onset of the next fault, None for the end of the bag.
            stands: how close to its last place the tip must stay to be at rest, m.
            pushed: the way of the tip is that of the hand.
        """
        first = self._onset(onset)
        last = self._row(end, first)
        healthy = max(first - 1, 0)  # a fast axis has moved by the row at which it sets in
        begin = int(np.searchsorted(self._time, self._time[healthy] - BEFORE))
        span = max(self._time[healthy] - self._time[begin], 1e-9)
        velocity = (self._tip[healthy] - self._tip[begin]) / span
        speed = float(np.linalg.norm(velocity))
        moved, passed = (of[healthy : last + 1] - of[healthy] for of in (self._tip, self._time))
        window, time = self._tip[first : last + 1], self._time[first : last + 1] - self._time[first]
        operating = self._state(onset)
        known = operating in ("", OperatingState.ENABLED)
        events = [event for event in self._events if onset <= event[0] <= end and (known or event[1] != SILENT)]
        if operating == OperatingState.FAULT:  # found before; the newest of what was said counts from the onset on
            events = [(onset, *event[1:]) for event in self._events if event[0] < onset and event[2]][-1:] + events
        fault = next((event for event in events if event[2]), None)
        reported = self._row(events[0][0], first) if events else last
        released, pressed, until = self._operator(last, following)
        return Outcome(
            label=label,
            speed=speed,
            reason=events[0][1] if events else "",
            detection=self._detection(events[0][0], first, last) if events else None,
            stop=_standstill(window, time, stands),
            travel=_reach(window, window[0]),
            excess=_off_hand(moved, self._hand(onset)) if pushed else _off_way(moved, passed, velocity),
            fault=fault is not None,
            alone=float(np.linalg.norm(self._tip[released] - self._tip[last])),
            resumed=_reach(self._tip[pressed : until + 1], self._tip[pressed]),
            to_end=float(self._to_end[first]),
            operating=operating,
            braking=_reach(self._tip[reported : last + 1], self._tip[reported]),
            faulted=None if fault is None else self._elapsed(fault[0], first),
            fault_reason="" if fault is None else fault[1],
        )

    def _state(self, stamp: int) -> str:
        """Return the operating state before a time, nothing where it was not recorded."""
        if "operating_state" not in self._run:
            return ""
        stream = self._run["operating_state"]
        before = int(np.searchsorted(stream.stamp, stamp))
        return str(stream.data[before - 1]) if before else ""

    def _elapsed(self, stamp: int, first: int) -> float:
        """Return the time from row `first` to a stamp; in wall time without rows, which end with a plant."""
        if self._stepped:
            return float(self._time[self._row(stamp, first)] - self._time[first])
        return float(stamp - self._stamp[first]) * 1e-9

    def _detection(self, report: int, first: int, last: int) -> float:
        """Return the time of the first reaction: the first report, or an earlier fall of the executed demand."""
        at, before = self._elapsed(report, first), max(first - 1, 0)
        demand = self._demand[before : last + 1].sum(axis=1)
        fallen = np.nonzero(demand < 0.8 * demand[0])[0] if demand[0] > 0.0 else []
        if len(fallen):
            at = min(at, float(self._time[before + int(fallen[0])] - self._time[first]))
        return at

    def _operator(self, last: int, following: int | None) -> tuple[int, int, int]:
        """Return the rows at which the pedal is released, pressed again, and the next fault sets in."""
        until = len(self._stamp) - 1 if following is None else self._row(following, last)
        pedal = self._run["mock/pedal"]
        inside = (pedal.stamp >= self._stamp[last]) & (pedal.stamp <= self._stamp[until])
        stamps, travel = pedal.stamp[inside], pedal.axes[inside, 0]
        down = stamps[travel <= 0.0]
        released = self._row(int(down[0]), last) if len(down) else until
        up = stamps[(travel > 0.0) & (stamps > down[0])] if len(down) else stamps[:0]
        pressed = self._row(int(up[0]), released) if len(up) else until
        return released, pressed, until


def _reach(tip: NDArray[np.float64], origin: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(tip - origin, axis=1).max()) if len(tip) else 0.0


def _off_way(moved: NDArray[np.float64], time: NDArray[np.float64], velocity: NDArray[np.float64]) -> float:
    """Return the largest distance [m] from the path that a tip at constant `velocity` has covered up to each time."""
    speed = float(np.linalg.norm(velocity))
    along = moved @ velocity / speed if speed > 0.0 else np.zeros(len(moved))
    nearest = np.clip(along, 0.0, speed * time)[:, None] * (velocity / speed if speed > 0.0 else 0.0)
    return float(np.linalg.norm(moved - nearest, axis=1).max())


def _off_hand(moved: NDArray[np.float64], force: NDArray[np.float64]) -> float:
    """Return the largest distance [m] from a way that begins where the tip is and goes on as the hand pushes."""
    size = float(np.linalg.norm(force))
    way = force / size if size > 0.0 else force
    along = np.maximum(moved @ way, 0.0)[:, None] * way
    return float(np.linalg.norm(moved - along, axis=1).max())


def _standstill(tip: NDArray[np.float64], time: NDArray[np.float64], stands: float) -> float | None:
    """Return when the tip has come to rest, None when it is still moving at the end."""
    away = np.linalg.norm(tip - tip[-1], axis=1) > stands
    moving = int(np.nonzero(away)[0][-1]) + 1 if away.any() else 0
    rest = time[-1] - time[min(moving, len(time) - 1)]
    return float(time[moving]) if rest >= BEFORE else None
