"""Candidates of the exact stages for the baselines: a delay of all commands or of one axis', another position gain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Run
from sher3_description import ACTUATORS, Robot

from sher3_challenge.baselines.inputs import Candidate, Stage

Array = NDArray[np.floating[Any]]

FLOOR = 1e-6
"""Floor of the exact stages as a share of the velocity limit: far above rounding, far below any effect."""
MAXIMUM_TICKS = 5
"""Whole ticks of delay that are tried."""
CLAMPED = 0.999
"""Share of the velocity limit from which a command counts as clamped."""


def exact_inputs(runs: Sequence[Run], robot: Robot) -> tuple[list[Stage], list[Candidate]]:
    """Return stages and single fits of transport (each axis, and all) and controller; residuals over `FLOOR`."""
    unit = FLOOR * np.array([actuator.limits.velocity for actuator in robot.actuators])
    stages: list[Stage] = []
    candidates: list[Candidate] = []
    able = [run for run in runs if "servo_jv" in run]
    sent = [(run["servo_jv"].velocity / unit, run["drives/setpoint_jv"].velocity / unit) for run in able
            if "drives/setpoint_jv" in run]  # fmt: skip
    places = [(name, [j]) for j, name in enumerate(ACTUATORS)] + [("all", list(range(len(ACTUATORS))))]
    for name, columns in places if sent else []:
        pairs = [(u[:, columns], e[:, columns]) for u, e in sent]
        stages.append(Stage(("transport", name), 1.0, [e[1:] - u[:-1] for u, e in pairs]))
        effect = "command_delay" if name == "all" else "axis_skew"
        candidates.append(Candidate(effect, "timing", ("transport", name), 1, _delayed(pairs)))
    steered = [run for run in able if "setpoint_js" in run and "measured_js" in run]
    for j, name in enumerate(ACTUATORS) if steered else []:
        laws = [_law(run, robot, j, unit[j]) for run in steered]
        stages.append(Stage(("controller", name), 1.0, [r for r, _ in laws]))
        size = sum(float((x * x).sum()) for _, x in laws)
        gain = sum(float((x * r).sum()) for r, x in laws) / size if size > 0 else 0.0
        fitted = [r - gain * x for r, x in laws]
        candidates.append(Candidate("controller_gain", "scale", ("controller", name), 1, fitted))
    return stages, candidates


def _delayed(pairs: Sequence[tuple[Array, Array]]) -> list[Array]:
    """Return the residuals of the best common delay: whole ticks, and a share of one that mixes two demands."""
    best: tuple[float, list[Array]] | None = None
    for ticks in range(MAXIMUM_TICKS):
        now = [np.roll(u, ticks + 1, axis=0) for u, _ in pairs]
        before = [np.roll(u, ticks + 2, axis=0) for u, _ in pairs]
        skip = MAXIMUM_TICKS + 2
        top = sum(float(((b - a) * (e - a))[skip:].sum()) for a, b, (_, e) in zip(now, before, pairs, strict=True))
        size = sum(float(((b - a) ** 2)[skip:].sum()) for a, b in zip(now, before, strict=True))
        share = min(1.0, max(0.0, top / size)) if size > 0 else 0.0
        left = [e - (1 - share) * a - share * b for a, b, (_, e) in zip(now, before, pairs, strict=True)]
        for rest in left:
            rest[:skip] = 0.0
        energy = sum(float((rest * rest).sum()) for rest in left)
        if best is None or energy < best[0]:
            best = (energy, [rest[1:] for rest in left])
    assert best is not None
    return best[1]


def _law(run: Run, robot: Robot, j: int, unit: float) -> tuple[Array, Array]:
    """Return the residual of the nominal law and its proportional part, (n, 1) each; zero where clamped."""
    setpoint, load = run["setpoint_js"], run["measured_js"].position[:, j]
    proportional = robot.position_gain * (setpoint.position[:, j] - load)
    command, limit = run["servo_jv"].velocity[:, j], robot.actuators[j].limits.velocity
    free = (np.abs(command) < CLAMPED * limit) & (np.abs(setpoint.velocity[:, j] + proportional) < limit)
    residual = np.where(free, command - setpoint.velocity[:, j] - proportional, 0.0)
    return residual[:, None] / unit, np.where(free, proportional, 0.0)[:, None] / unit
