"""End to end: diagnose a case, put the causes into the simulator, run it again, see how far the gap has closed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_description import Robot
from sher3_diagnosis.verdict import Verdict
from sher3_effects import to_effects
from sher3_gap.sher import diagnose_runs
from sher3_gap.signals import RunSignals
from sher3_gap.simulate.apply import StageGap, compare_case


@dataclass(frozen=True)
class Closing:
    """What applying a verdict did to the gap between the robot and its simulator.

    Attributes:
        verdict: of the case.
        first: the place the verdict names first; None without a gap or without a cause to apply.
        tip: the tip's position, both running freely; None where it was not tracked or the simulator knows no cause.
    """

    verdict: Verdict
    first: StageGap | None
    tip: StageGap | None


def close_loop(runs: Sequence[RunSignals], robot: Robot) -> Closing:
    """Diagnose runs, apply the causes, and compare nominal and corrected simulator with the robot."""
    verdict = diagnose_runs(runs, robot).verdict
    effects = to_effects(verdict.causes, robot)
    if not effects:
        return Closing(verdict, None, None)
    rows = compare_case(runs, robot, effects)
    place = verdict.where[0]
    there = [r for r in rows if r.stage == place.stage]
    first = next((r for r in there if r.actuator == place.actuator), there[0] if there else None)
    return Closing(verdict, first, next((r for r in rows if r.stage == "end to end"), None))
