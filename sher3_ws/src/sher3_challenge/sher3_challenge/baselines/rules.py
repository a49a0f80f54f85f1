"""What others would answer on the same residuals: four baselines, as verdicts that the same scores judge.

- `best_rmse`: the single effect that fits best. Fits always find something.
- `iid_bic`: the single effect with the largest BIC gain over the nominal model, samples taken as independent.
- `all_parameters`: all effects at once, those whose iid interval excludes zero are named (as `mujoco.sysid` reports).
- `trace_metrics`: RMSE and lag of joint traces, simulated against measured (as SAGE reports); names joints, not causes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from sher3_challenge.baselines.inputs import Array, Candidate, Inputs, Place, Stage, Traces

Answer = dict[str, Any]

BIC_GAIN = 10.0
"""Gain that is called very strong evidence (Kass and Raftery 1995)."""
MAXIMUM_LAG = 50
"""Largest shift tried [samples]: 0.1 s at 500 Hz."""
Z = 1.96
"""Standard deviations of a 95 % interval."""
SINGULAR = 1e-8
"""Share of the largest singular value below which directions of a joint fit are left out."""
TINY = 1e-300
"""Keeps a division by an energy of zero finite."""


def _energy(runs: Sequence[Array]) -> float:
    return float(sum(np.sum(np.square(run)) for run in runs))


def _samples(runs: Sequence[Array]) -> int:
    return sum(run.size for run in runs)


def _closure(stage: Stage, left: float) -> float:
    n = max(1, _samples(stage.nominal) // max(1, stage.nominal[0].shape[1] if stage.nominal else 1))
    before, after = _energy(stage.nominal) / n, left / n
    return (before - after) / (before - stage.floor) if before > stage.floor else 0.0


def _cause(candidate: Candidate) -> dict[str, Any]:
    return {
        "effect": candidate.effect,
        "family": candidate.family,
        "stage": candidate.place[0],
        "actuator": candidate.place[1],
        "parameters": {},
        "rivals": [],
    }


def _answer(stage: Stage, causes: Sequence[Candidate], left: float) -> Answer:
    place = {"stage": stage.place[0], "actuator": stage.place[1]}
    closure = {"stage": {"value": _closure(stage, left), "low": None, "high": None}, "tip": None}
    return {"status": "attributed", "where": [place], "causes": [_cause(c) for c in causes], "closure": closure}


NO_GAP: Answer = {"status": "no_gap", "where": [], "causes": [], "closure": {}}


def best_rmse(data: Inputs) -> Answer:
    """Name the effect whose fit takes most off the residual, in units of the stage's floor."""
    stages = {stage.place: stage for stage in data.stages}

    def gain(candidate: Candidate) -> float:
        stage = stages[candidate.place]
        return (_energy(stage.nominal) - _energy(candidate.fitted)) / max(stage.floor, TINY)

    able = [c for c in data.candidates if c.place in stages]
    if not able:
        return NO_GAP
    best = max(able, key=gain)
    return _answer(stages[best.place], [best], _energy(best.fitted))


def iid_bic(data: Inputs) -> Answer:
    """Name the effect with the largest BIC gain, if it is very strong; every sample counts as independent."""
    stages = {stage.place: stage for stage in data.stages}

    def gain(candidate: Candidate) -> float:
        nominal = stages[candidate.place].nominal
        n = max(2, _samples(nominal))
        ratio = max(_energy(nominal), TINY) / max(_energy(candidate.fitted), TINY)
        return n * math.log(ratio) - candidate.size * math.log(n)

    able = [c for c in data.candidates if c.place in stages]
    best = max(able, key=gain, default=None)
    if best is None or gain(best) < BIC_GAIN:
        return NO_GAP
    return _answer(stages[best.place], [best], _energy(best.fitted))


def all_parameters(data: Inputs) -> Answer:
    """Fit all effects of every stage together, linear about their single fits; name those that iid intervals keep."""
    found: list[tuple[float, Candidate]] = []
    left: dict[Place, float] = {}
    stages = {stage.place: stage for stage in data.stages}
    for place, stage in stages.items():
        members = [c for c in data.candidates if c.place == place]
        if members:
            kept, left[place] = _joint_fit(stage, members)
            found += kept
    if not found:
        return NO_GAP
    found.sort(key=lambda item: -item[0])
    place = found[0][1].place
    return _answer(stages[place], [c for _, c in found], left[place])


def _joint_fit(stage: Stage, members: Sequence[Candidate]) -> tuple[list[tuple[float, Candidate]], float]:
    """Fit the effects of one stage together.

    Returns:
        The effects whose interval excludes zero, each with its rms over the floor; and the energy that is left.
    """
    y = np.concatenate([run.ravel() for run in stage.nominal])
    x = np.column_stack([y - np.concatenate([run.ravel() for run in c.fitted]) for c in members])
    acts = np.linalg.norm(x, axis=0) > 0
    members, x = [c for c, on in zip(members, acts, strict=True) if on], x[:, acts]
    if not members:
        return [], float(y @ y)
    weights, *_ = np.linalg.lstsq(x, y, rcond=SINGULAR)
    rest = y - x @ weights
    left = float(rest @ rest)
    variance = left / max(1, len(y) - len(members))
    spread = np.sqrt(variance * np.diag(np.linalg.pinv(x.T @ x)))
    part = np.linalg.norm(x * weights, axis=0) / math.sqrt(len(y) * max(stage.floor, TINY))
    kept = (spread > 0) & (np.abs(weights) > Z * spread)
    return [(float(p), c) for p, c, keep in zip(part, members, kept, strict=True) if keep], left


def lag_of(a: Array, b: Array) -> int:
    """Return the shift of `b` (n,) against `a` [samples] of the largest cross-correlation, means kept as SAGE does."""
    n = len(a)
    shifts = range(-MAXIMUM_LAG, MAXIMUM_LAG + 1)
    products = [float(np.dot(a[max(0, -s) : n - max(0, s)], b[max(0, s) : n - max(0, -s)])) for s in shifts]
    return int(shifts[int(np.argmax(products))])


def trace_metrics(data: Inputs) -> Answer:
    """Rank joints by RMSE over their travel; call a lag a delay, and everything else a gap without a cause."""
    traces = data.traces
    if traces is None or not traces.measured:
        return NO_GAP
    errors = [_relative_error(traces, j) for j in range(len(traces.actuators))]
    worst = int(np.argmax(errors))
    lag = _median_lag(traces, worst)
    place = {"stage": "transport" if lag > 0 else "motor_mechanics", "actuator": traces.actuators[worst]}
    answer = {"status": "outside_library", "where": [place], "causes": [], "closure": {}}
    if lag > 0:
        cause = {"effect": "command_delay", "family": "timing", **place, "parameters": {}, "rivals": []}
        answer |= {"status": "attributed", "causes": [cause]}
    return answer


def _relative_error(traces: Traces, joint: int) -> float:
    """Return a joint's RMSE over all runs as a share of its travel; 0 for one that does not move."""
    pairs = [(m[:, joint], s[:, joint]) for m, s in zip(traces.measured, traces.simulated, strict=True)]
    travel = max(float(np.ptp(m)) for m, _ in pairs)
    rmse = math.sqrt(float(np.mean([np.mean((m - s) ** 2) for m, s in pairs])))
    return rmse / travel if travel > 0 else 0.0


def _median_lag(traces: Traces, joint: int) -> int:
    """Return by how many samples a joint's measured position lags the simulated one; 0 for one that never moves."""
    moving = [(m[:, joint], s[:, joint]) for m, s in zip(traces.measured, traces.simulated, strict=True)]
    lags = [lag_of(s, m) for m, s in moving if np.ptp(m) > 0]
    return round(float(np.median(lags))) if lags else 0


BASELINES: Mapping[str, Callable[[Inputs], Answer]] = {
    "best_rmse": best_rmse,
    "iid_bic": iid_bic,
    "all_parameters": all_parameters,
    "trace_metrics": trace_metrics,
}
