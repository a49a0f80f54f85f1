"""The evidence of a case: runs, residuals, floors and standardised targets, prepared once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel, Floors, Residual, Residuals
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.tolerance import Tolerance, as_built, tolerance
from sher3_effects import library

from sher3_gap.nominal_replay import driven_as, first_alike, followed
from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.timing import Timing, demand_in_force, timing_of
from sher3_gap.stages.floors import floors, with_load
from sher3_gap.stages.geometry import Geometry
from sher3_gap.stages.residuals import Demand, all_residuals, motor_residual
from sher3_gap.stages.units import PLACES, ROTARY_AXES, unit_of
from sher3_gap.stages.view import SherView


@dataclass(frozen=True, kw_only=True)
class SherEvidence(Evidence):
    """The engine's evidence with what the robot's exact stages and its simulator need.

    Attributes:
        runs: signals of every run.
        robot: the nominal model.
        twins: the nominal model driven as each run was.
        timing: what the echo tells of the commands' timing; None where it was not recorded.
        tolerances: deviations within tolerance one by one, which `nuisance` has in principal directions.
    """

    runs: Sequence[RunSignals]
    robot: Robot
    twins: Sequence[RunSignals]
    timing: Timing | None
    tolerances: Sequence[Tolerance]

    def view(self, run: int) -> SherView:
        """Return what effects see of a run."""
        found = self.data.views[run]
        assert isinstance(found, SherView)
        return found


SHIFTS = (0.0, 0.5)
"""Shares of an encoder count by which the simulated twins are shifted."""


def twins_of(run: RunSignals, robot: Robot) -> list[RunSignals]:
    """Return the nominal plant driven as a run was, once for each shift; a run without set-points is followed."""
    made = (driven_as(followed(run), robot, shift=shift) for shift in SHIFTS)
    return [twin for twin in made if twin is not None]


def gather(runs: Sequence[RunSignals], robot: Robot) -> SherEvidence:
    """Compute residuals, floors and standardised targets of a case."""
    geometry = Geometry(robot)
    timing = timing_of(runs, robot)
    demands = [demand_in_force(run, robot, timing) for run in runs]
    residuals = [all_residuals(run, robot, geometry, d) for run, d in zip(runs, demands, strict=True)]
    first = first_alike(runs)
    made = {r: twins_of(runs[r], robot) for r in set(first)}
    simulated = {r: [all_residuals(twin, robot, Geometry(robot)) for twin in own] for r, own in made.items()}
    own = floors(runs, residuals, [simulated[r] for r in first], robot)
    own = [with_load(f, run, robot, geometry) for f, run in zip(own, runs, strict=True)]
    views = [SherView(run, robot, geometry) for run in runs]
    largest = largest_force(runs)
    residuals = [
        _follow_the_drive(run, robot, geometry, r, f, d, largest)
        for run, r, f, d in zip(runs, residuals, own, demands, strict=True)
    ]
    data = Standardised(views, residuals, own)
    tolerances = list(tolerated(data, robot))
    return SherEvidence(
        excitations=[run.excitation for run in runs],
        data=data,
        units={c: unit_of(c) for run in residuals for c in run},
        places=PLACES,
        rotary=ROTARY_AXES,
        counts={a: x.motor_encoder for a, x in zip(ACTUATORS, robot.actuators, strict=True)},
        nuisance=as_built(data, tolerances),
        runs=list(runs),
        robot=robot,
        twins=[made[r][0] for r in first],
        timing=timing,
        tolerances=tolerances,
    )


def tolerated(data: Standardised, robot: Robot) -> Iterator[Tolerance]:
    """Return what the robot may deviate by from its drawing, as its pages say."""
    for page in library().values():
        for site in (s for place in page.places for s in PLACES[place]):
            for found in page.tolerated(robot, site):
                yield tolerance(data, page, site, found.shape, dict(found.limits))


def largest_force(runs: Sequence[RunSignals]) -> Array | None:
    """Largest force each drive reports but for a thousandth of the ticks, (axes,); None where none is recorded."""
    efforts = [np.abs(run.effort) for run in runs if run.effort is not None]
    return np.quantile(np.concatenate(efforts), 0.999, axis=0) if efforts else None


def _follow_the_drive(
    run: RunSignals,
    robot: Robot,
    geometry: Geometry,
    residuals: Residuals,
    floor: Floors,
    demand: Demand | None,
    largest: Array | None,
) -> Residuals:
    """Where a drive does not follow its law its force need not step with the demand.

    It may end at a limit, or it may follow continuously, wholly or in part. What fits best is taken.
    """
    odd = [a for a in ACTUATORS if _ratio(residuals, floor, Channel("drive", a)) > 1.3]
    if not odd:
        return residuals
    smooth = motor_residual(run, robot, geometry, demand, steps=False)
    ended = motor_residual(run, robot, geometry, demand, limit=largest)
    out = dict(residuals)
    for channel in (Channel("motor_mechanics", a) for a in odd):
        if channel not in out:
            continue
        full, ok = out[channel].values, out[channel].ok
        step = full - smooth[channel].values
        energy = float(np.sum(step[ok] ** 2))
        share = float(np.clip(np.sum(step[ok] * full[ok]) / energy, 0.0, 1.0)) if energy > 0.0 else 0.0
        tried = (full - share * step, ended[channel].values)
        out[channel] = Residual(min(tried, key=lambda x: float(np.sum(x[ok] ** 2))), ok)
    return out


def _ratio(residuals: Residuals, floor: Floors, channel: Channel) -> float:
    if channel not in residuals:
        return 0.0
    return float(np.max(residuals[channel].rms() / floor[channel]))
