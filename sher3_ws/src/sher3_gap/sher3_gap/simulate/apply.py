"""Put the causes of a verdict into the simulator, and show what that does to the gap of the recorded case.

The check is end to end: the corrected simulator runs freely from the recorded set-points and loads, its readings go
through the same residuals as the robot's, and what counts is the difference between the two.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import numpy as np
from sher3_common import FileError, Sher3Error
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.bet import bets, betting
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.verdict import Schema, Verdict
from sher3_effects import save_effects, to_effects
from sher3_sim import PlantEffect

from sher3_gap.nominal_replay import driven_as
from sher3_gap.signals import RunSignals
from sher3_gap.simulate.tip import tip_error
from sher3_gap.stages.exact.law import EXACT, controller_error, transport_error
from sher3_gap.stages.floors import resolution_floors
from sher3_gap.stages.geometry import Geometry
from sher3_gap.stages.residuals import Residuals, all_residuals
from sher3_gap.stages.units import unit_of

PLACES = (*ACTUATORS, "tip", "force_sensor", "all")
"""Where a cause can sit on the SHER."""


class ApplyError(Sher3Error):
    """A verdict that cannot be put into the simulator."""


EXPORT = "write it into a model of that machine: `sher3 gap export`; its `--check CASE` runs that model on the records"
"""What takes the place of the SHER's simulator for another machine."""


@dataclass(frozen=True)
class StageGap:
    """Gap of one stage between robot and simulator before and after, and what the readings resolve; rms, SI units."""

    stage: str
    actuator: str
    before: float
    after: float
    floor: float
    unit: str

    @property
    def closure(self) -> float | None:
        """Share of the squared gap above the floor that is gone; None where there was none."""
        above = self.before**2 - self.floor**2
        return None if above <= self.floor**2 else (self.before**2 - self.after**2) / above


def read_verdict(path: Path, instead: str = EXPORT, bet: bool = False) -> Verdict:
    """Read a verdict file.

    Args:
        path: of the file.
        instead: what to do with a verdict on another machine.
        bet: take the best bets for the causes, also where the verdict abstains.

    Raises:
        ApplyError: it cannot be read, is not a verdict, or is one on another machine than the SHER.
        NoBetError: a bet is asked for and there is none.
    """
    try:
        found = Verdict.read(path)
    except FileError as error:
        raise ApplyError(str(error), value=error.value, limit=error.limit, remedy="name a verdict.json") from error
    except ValueError as error:
        reason = str(error).splitlines()[0]
        raise ApplyError(
            f"{path}: is not a verdict",
            value=reason,
            limit=" or ".join(get_args(Schema)),
            remedy="name a verdict.json of `sher3 gap diagnose`",
        ) from error
    found = betting(found) if bet else found
    foreign = [c.actuator for c in found.causes if c.actuator not in PLACES]
    if foreign:
        raise ApplyError(
            f"{path}: is a verdict on another machine",
            value=foreign[0],
            limit=", ".join(PLACES),
            remedy=instead,
        )
    return found


def effects_of(verdict: Verdict, robot: Robot) -> list[PlantEffect]:
    """Return the effects a verdict puts into the simulator.

    Raises:
        ApplyError: the verdict names no cause, or none the simulator knows.
    """
    if not verdict.causes:
        remedy = "take the best bet: --bet" if bets(verdict) else "use the nominal simulator"
        raise ApplyError(f"a verdict {verdict.status!r} names no cause to apply", remedy=remedy)
    effects = to_effects(verdict.causes, robot)
    if not effects:
        names = ", ".join(c.effect for c in verdict.causes)
        raise ApplyError(
            "the simulator has no counterpart of the causes", value=names, remedy="correct the model by hand"
        )
    return effects


def apply_verdict(verdict: Path, output: Path, robot: Robot, bet: bool = False) -> list[PlantEffect]:
    """Write the effects file of a verdict, or of its best bets, and return the effects; raises ApplyError."""
    effects = effects_of(read_verdict(verdict, bet=bet), robot)
    save_effects(output, effects)
    return effects


def compare_case(runs: Sequence[RunSignals], robot: Robot, effects: Sequence[PlantEffect]) -> list[StageGap]:
    """Run every recorded run again in the nominal and the corrected simulator and compare each with the robot.

    Raises:
        ApplyError: no run has set-points to run again.
    """
    return _compared(runs, robot, [driven_as(run, robot, seed=k, effects=effects) for k, run in enumerate(runs)])


def compare_cases(runs: Sequence[RunSignals], robot: Robot, others: Sequence[RunSignals]) -> list[StageGap]:
    """Compare recorded runs with the nominal simulator, and with recordings of the same excitations elsewhere.

    Raises:
        ApplyError: the other case has no run of the same excitation, or no run has set-points.
    """
    given: dict[str, list[RunSignals]] = defaultdict(list)
    for other in others:
        given[other.excitation].append(other)
    twins = [given[run.excitation].pop(0) if given[run.excitation] else None for run in runs]
    if not any(twins):
        names = ", ".join(sorted({run.excitation for run in others}))
        raise ApplyError("the cases share no excitation", value=names, remedy="run the same excitations on both")
    kept = [(run, twin) for run, twin in zip(runs, twins, strict=True) if twin is not None]
    return _compared([run for run, _ in kept], robot, [twin for _, twin in kept])


def _compared(runs: Sequence[RunSignals], robot: Robot, twins: Sequence[RunSignals | None]) -> list[StageGap]:
    if not any(run.reference is not None for run in runs):
        raise ApplyError("no run has set-points to run again", remedy="record setpoint_js")
    before, after = _Sums(), _Sums()
    geometry = Geometry(robot)
    for k, (run, twin) in enumerate(zip(runs, twins, strict=True)):
        nominal = driven_as(run, robot, seed=k)
        if nominal is None or twin is None:
            continue
        real = _readings(run, robot, geometry)
        for sums, other in ((before, nominal), (after, twin)):
            sums.add(real, _readings(other, robot, Geometry(robot)))
            if run.tracker_position is not None and other.tracker_position is not None:
                sums.add_tip(tip_error(run, other))
    return _stages(before, after, robot, runs[0].period)


class _Sums:
    """Mean square differences per channel."""

    def __init__(self) -> None:
        self.square: dict[Channel, float] = defaultdict(float)
        self.count: dict[Channel, int] = defaultdict(int)

    def add(self, real: Residuals, twin: Residuals) -> None:
        for channel in real.keys() & twin.keys():
            a, b = real[channel], twin[channel]
            n = min(len(a.values), len(b.values))
            ok = a.ok[:n] & b.ok[:n]
            part = 3 if a.values.shape[1] == 6 else 1
            self._add(channel, (a.values[:n] - b.values[:n])[ok][:, :part])

    def add_tip(self, error: Array) -> None:
        self._add(Channel("end to end", "tip"), error)

    def _add(self, channel: Channel, difference: Array) -> None:
        self.square[channel] += float(np.sum(np.mean(difference**2, axis=1)))
        self.count[channel] += len(difference)

    def rms(self, channel: Channel) -> float:
        return float(np.sqrt(self.square[channel] / max(1, self.count[channel])))


def _readings(run: RunSignals, robot: Robot, geometry: Geometry) -> Residuals:
    """Residuals of every stage of a run, the exact ones included."""
    out = all_residuals(run, robot, geometry)
    for stage, error in (("transport", transport_error(run)), ("controller", controller_error(run, robot))):
        if error is not None:
            grid = np.linalg.norm(error, axis=1, keepdims=True)[run.grid]
            out[Channel(stage, "all")] = type(next(iter(out.values())))(grid, run.inner)
    return out


def _stages(before: _Sums, after: _Sums, robot: Robot, period: float) -> list[StageGap]:
    least = resolution_floors(robot, period)
    top = float(np.median([a.limits.velocity for a in robot.actuators]))
    rows = []
    for channel in sorted(before.square):
        floor = float(np.sqrt(2.0) * np.mean(least[channel][:3])) if channel in least else EXACT * top
        unit = "m" if channel.stage == "end to end" else unit_of(channel)
        if channel.stage == "end to end":
            floor = robot.tracker.noise_position
        rows.append(StageGap(channel.stage, channel.actuator, before.rms(channel), after.rms(channel), floor, unit))
    return rows
