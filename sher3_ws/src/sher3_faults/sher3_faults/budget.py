"""The travel budget: how far the tip may travel after each fault, and whether its speed regime allows that.

travel = speed (detection + stop) + parting. `stop` is the time at full speed that covers the braking distance
(`braking`), `parting` the tip travel that belongs to the largest difference of the encoders that is not noticed.
"""

from __future__ import annotations

from itertools import groupby
from typing import Any, NamedTuple

import numpy as np
from sher3_common import Sher3Error
from sher3_common.vectors import Vector
from sher3_control.motion.speed_cap import Regime, SpeedCap, axis_caps, speed_cap
from sher3_control.settings import ControlSettings
from sher3_description import ACTUATORS, Robot
from sher3_drivers.settings import MotorDriverSettings
from sher3_kinematics import RobotKinematics

from sher3_faults.braking import braking_of
from sher3_faults.creep import SPEEDS, Creep, FalseForce, creeps, cut_off, false_forces, given_way, per_axis
from sher3_faults.fault_classes import FaultClass, fault_classes

GUARDED = (Regime.NEAR_TISSUE, Regime.FREE)
"""Regimes with a stated budget."""
RUNAWAY = {Regime.NEAR_TISSUE: 40e-6, Regime.FREE: 250e-6}
"""Largest tip travel of axes that go by themselves, one to five, at any speed up to the limits of their drives [m]."""


CUT_OFF = {Regime.NEAR_TISSUE: 95e-6, Regime.FREE: 660e-6}
"""What is stated of the same [m] where the drive of such an axis is cut off too: it stops by its own watch alone."""


class BudgetRow(NamedTuple):
    """One fault in one regime; times in s, lengths in m, `speed` in m/s; `budget` is infinite on the bench."""

    regime: str
    fault: str
    reason: str
    detection: float
    stop: float
    speed: float
    parting: float
    travel: float
    budget: float
    setting: str


class BudgetExceeded(Sher3Error):
    """A fault's travel exceeds the budget of its regime; carries the `row`, names settings that keep it."""

    exit_code = 2

    def __init__(self, row: BudgetRow, longest: float, fastest: float) -> None:
        name = "near_speed" if row.regime == Regime.NEAR_TISSUE.value else "free_speed"
        remedies = [f"lower {row.setting}"]
        if longest > 0.0:
            remedies = [f"shorten {row.setting} so that it is noticed within {longest * 1e3:.1f} ms"]
        if fastest > 0.0:
            option = name.replace("_", "-")
            remedies.append(f"lower motion.{name} (--{option}) to {fastest:.6f} m/s")
        super().__init__(
            f"travel budget of the regime {row.regime} exceeded: {row.fault} ({row.reason}) is noticed after "
            f"{row.detection * 1e3:.1f} ms and stopped in {row.stop * 1e3:.1f} ms at {row.speed * 1e3:g} mm/s",
            value=f"{row.travel * 1e6:.1f} um",
            limit=f"{row.budget * 1e6:g} um",
            remedy=", or ".join(remedies),
        )
        self.row = row


class TravelBudget:
    """The budget of a configuration.

    Attributes:
        rows: every fault in every regime.
        creeps: tip travel with an axis that goes by itself, per regime: every axis, speed and echo.
        cut_off: tip travel [m] per regime and axis that goes by itself while its drive neither hears nor is heard.
        runaway: tip travel [m] per regime and axis when its drive does not obey and runs at its own speed limit, which
            is the cap of the regime.
    """

    def __init__(self, robot: Robot, control: ControlSettings, drives: MotorDriverSettings) -> None:
        self._braking, self._robot = braking_of(robot.to_yaml()), robot
        self._control, self._drives = control, drives
        self._ki = np.array([actuator.drive.ki for actuator in robot.actuators])
        self._classes = fault_classes(control, drives)
        self.rows = [row for regime in Regime for row in self._rows(regime, self._cap(regime))]
        self.creeps = {regime.value: self._creeps(regime) for regime in Regime}
        self.cut_off = {regime.value: cut_off(self._braking, drives, self._axis_caps(regime)) for regime in Regime}
        self.runaway = {
            regime: {creep.axis: creep.travel for creep in found if creep.echo == "false"}
            for regime, found in self.creeps.items()
        }

    def _cap(self, regime: Regime) -> SpeedCap:
        cap = speed_cap(self._control.motion, regime)
        if regime is Regime.BENCH:
            return SpeedCap(self._braking.top_speed(), float(self._braking.velocity[3]))
        return cap

    def _axis_caps(self, regime: Regime) -> Vector:
        motion = self._control.motion
        return axis_caps(motion, speed_cap(motion, regime), self._braking.velocity.tolist())

    def _creeps(self, regime: Regime) -> list[Creep]:
        return creeps(self._braking, self._drives, self._axis_caps(regime), self._cap(regime))

    def false_forces(self, regime: Regime) -> list[FalseForce]:
        """Return what comes of a false force in a regime; on the bench, where nobody watches, nothing is stated."""
        if regime is Regime.BENCH:
            return []
        cap = self._cap(regime)
        ramp = self._braking.distances(cap.linear, cap.angular)[1] / cap.linear
        return false_forces(self._control, RobotKinematics(self._robot), cap, ramp, self._drives.period)

    def _rows(self, regime: Regime, cap: SpeedCap) -> list[BudgetRow]:
        motion = self._control.motion
        budgets = {Regime.NEAR_TISSUE: motion.near_travel, Regime.FREE: motion.free_travel}
        zero, ramp = self._braking.distances(cap.linear, cap.angular)
        distance = {"zero": zero, "ramp": ramp}
        drives = self._drives
        encoders = per_axis(drives.encoder_distance, drives.encoder_angle)
        position = per_axis(drives.position_distance, drives.position_angle)
        position = position + drives.position_lag * self._braking.axis_speeds(cap.linear, cap.angular)
        reach = self._braking.reach()
        parting = {"": 0.0, "encoders": float((reach * encoders).max()), "position": float((reach * position).max())}
        rows = []
        for item in self._classes:
            way = parting[item.apart]
            travel = cap.linear * item.detection + distance[item.stop] + way
            rows.append(_row(regime, item, distance[item.stop] / cap.linear, cap.linear, way, travel, budgets))
        return rows

    def of(self, regime: Regime) -> list[BudgetRow]:
        """Return the rows of a regime, the longest travel first."""
        return sorted((row for row in self.rows if row.regime == regime.value), key=lambda row: -row.travel)

    def require(self) -> None:
        """Refuse a configuration that does not keep its budgets.

        Raises:
            BudgetExceeded: names the fault that exceeds its budget most, and what to change.
        """
        over = [row for regime in GUARDED for row in self.of(regime) if row.travel > row.budget]
        if not over:
            return
        worst = max(over, key=lambda row: row.travel / row.budget)
        longest = (worst.budget - worst.parting) / worst.speed - worst.stop
        raise BudgetExceeded(worst, longest, self._fastest(worst))

    def _fastest(self, row: BudgetRow) -> float:
        """Return the largest speed [m/s] at which the row keeps its budget, the turning lowered alike; by bisection."""
        regime = Regime(row.regime)
        cap, low, high = self._cap(regime), 0.0, 1.0
        for _ in range(12):
            share = 0.5 * (low + high)
            rows = self._rows(regime, SpeedCap(share * cap.linear, share * cap.angular))
            fits = next(r for r in rows if r.fault == row.fault).travel <= row.budget
            low, high = (share, high) if fits else (low, share)
        return low * cap.linear

    def to_dict(self) -> dict[str, Any]:
        """Return everything as plain data; an infinite budget is None."""
        rows = [{**row._asdict(), "budget": row.budget if np.isfinite(row.budget) else None} for row in self.rows]
        creep = {regime: [found._asdict() for found in self.creeps[regime]] for regime in self.creeps}
        forces = {regime.value: [_plain(found) for found in self.false_forces(regime)] for regime in GUARDED}
        most = {regime.value: travel for regime, travel in RUNAWAY.items()}
        stated = {"runaway": self.runaway, "runaway_budget": most, "cut_off": self.cut_off}
        return {"rows": rows, **stated, "creep": creep, "false_force": forces}

    def as_text(self) -> str:
        """Return the tables."""
        parts = []
        for regime in Regime:
            rows = self.of(regime)
            limit = f"budget {rows[0].budget * 1e6:g} um" if np.isfinite(rows[0].budget) else "no travel guarantee"
            parts.append(f"{regime.value}: tip speed {rows[0].speed * 1e3:.3g} mm/s, {limit}")
            parts.append(f"  {'fault':34}{'reason':19}{'detect':>9}{'stop':>9}{'travel':>11}")
            parts += [
                f"  {row.fault:34}{row.reason:19}{row.detection * 1e3:6.1f} ms{row.stop * 1e3:6.1f} ms"
                f"{row.travel * 1e6:8.1f} um{'  OVER' if row.travel > row.budget else ''}"
                for row in rows
            ]
        for regime in Regime:
            parts += self._stated(regime)
        return "\n".join(parts)

    def _stated(self, regime: Regime) -> list[str]:
        """Return the lines on axes that go by themselves, and on false forces."""
        found = self.creeps[regime.value]
        most = f", budget {RUNAWAY[regime] * 1e6:g}" if regime in RUNAWAY else ""
        lines = [f"{regime.value}: an axis that goes by itself, to its drive's own limit; travel of the tip [um]{most}"]
        lines.append(f"  {'axis, echo of its drive':34}" + "".join(f"{speed:>9g}" for speed in SPEEDS) + "    limit")
        for (axis, echo), some in groupby(found, key=lambda one: (one.axis, one.echo)):
            lines.append(f"  {axis + ', ' + echo:34}" + "".join(f"{1e6 * one.travel:9.1f}" for one in some))
        cut = self.cut_off[regime.value].items()
        lines.append(
            "  cut off as well, at the limit" + ",".join(f" {1e6 * way:.1f} um by {name}" for name, way in cut)
        )
        gives = given_way(self._braking, self._ki, self._drives.position_force)
        lines.append(
            "  each newton of a hand adds"
            + ",".join(f" {1e6 * way:.1f} um by {name}" for name, way in zip(ACTUATORS, gives, strict=True))
        )
        forces = self.false_forces(regime)
        if forces:
            lines.append(f"{regime.value}: a hand that has left a sensor that stays where it was")
        for one in forces:
            never = one.travel if np.isfinite(one.travel) else None
            far = "believed until the pedal is released" if never is None else f"{never * 1e6:8.1f} um"
            lines.append(f"  {one.force:4.1f} N, noticed after {one.detection * 1e3:6.0f} ms  {far}")
        return lines


def _plain(found: FalseForce) -> dict[str, float | None]:
    """Return a false force as plain data; what never ends is None."""
    return {name: value if np.isfinite(value) else None for name, value in found._asdict().items()}


def _row(
    regime: Regime,
    item: FaultClass,
    stop: float,
    speed: float,
    parting: float,
    travel: float,
    budgets: dict[Regime, float],
) -> BudgetRow:
    budget = budgets.get(regime, float("inf"))
    return BudgetRow(
        regime.value, item.fault, item.reason.name, item.detection, stop, speed, parting, travel, budget, item.setting
    )
