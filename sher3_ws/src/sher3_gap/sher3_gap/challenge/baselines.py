"""What others would answer on the same residuals: four baselines, as verdicts that the same scores judge.

- `best_rmse`: the single effect that fits best. Fits always find something.
- `iid_bic`: the single effect with the largest BIC gain over the nominal model, samples taken as independent.
- `all_parameters`: all effects at once, those whose iid interval excludes zero are named (as `mujoco.sysid` reports).
- `trace_metrics`: RMSE and lag of joint traces, simulated against measured (as SAGE reports); names joints, not causes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.floating[Any]]
Answer = dict[str, Any]
Place = tuple[str, str]

BIC_GAIN = 10.0
"""Gain that is called very strong evidence (Kass and Raftery 1995)."""
MAXIMUM_LAG = 50


class StageData(Protocol):
    """Nominal residuals of one stage at one actuator."""

    @property
    def place(self) -> Place:
        """Stage and actuator."""

    @property
    def floor(self) -> float:
        """Mean-square floor of the residual."""

    @property
    def nominal(self) -> Sequence[Array]:
        """Residuals (n, d) per run."""


class CandidateData(Protocol):
    """One effect fitted alone at its stage."""

    @property
    def effect(self) -> str:
        """Effect id."""

    @property
    def family(self) -> str:
        """Family id."""

    @property
    def place(self) -> Place:
        """Stage and actuator whose residual it was fitted to."""

    @property
    def size(self) -> int:
        """Number of fitted parameters."""

    @property
    def fitted(self) -> Sequence[Array]:
        """Residuals (n, d) per run with the effect at its best fit."""


class TraceData(Protocol):
    """Measured and simulated positions of all joints."""

    @property
    def actuators(self) -> Sequence[str]:
        """Names of the columns."""

    @property
    def measured(self) -> Sequence[Array]:
        """(n, joints) per run."""

    @property
    def simulated(self) -> Sequence[Array]:
        """(n, joints) per run, nominal model from the set-points."""


class BaselineInput(Protocol):
    """What every baseline gets: the residuals the diagnosis works with, and its single fits."""

    @property
    def stages(self) -> Sequence[StageData]:
        """All stages."""

    @property
    def candidates(self) -> Sequence[CandidateData]:
        """All effects, fitted one at a time."""

    @property
    def traces(self) -> TraceData | None:
        """Joint traces; None where the set-points are not recorded."""


@dataclass(frozen=True)
class Stage:
    """Plain `StageData`."""

    place: Place
    floor: float
    nominal: Sequence[Array]


@dataclass(frozen=True)
class Candidate:
    """Plain `CandidateData`."""

    effect: str
    family: str
    place: Place
    size: int
    fitted: Sequence[Array]


@dataclass(frozen=True)
class Traces:
    """Plain `TraceData`."""

    actuators: Sequence[str]
    measured: Sequence[Array]
    simulated: Sequence[Array]


@dataclass(frozen=True)
class Inputs:
    """Plain `BaselineInput`."""

    stages: Sequence[Stage]
    candidates: Sequence[Candidate]
    traces: Traces | None = None


def _energy(runs: Sequence[Array]) -> float:
    return float(sum(np.sum(np.square(run)) for run in runs))


def _samples(runs: Sequence[Array]) -> int:
    return sum(run.size for run in runs)


def _closure(stage: StageData, left: float) -> float:
    n = max(1, _samples(stage.nominal) // max(1, stage.nominal[0].shape[1] if stage.nominal else 1))
    before, after = _energy(stage.nominal) / n, left / n
    return (before - after) / (before - stage.floor) if before > stage.floor else 0.0


def _cause(candidate: CandidateData) -> dict[str, Any]:
    return {
        "effect": candidate.effect,
        "family": candidate.family,
        "stage": candidate.place[0],
        "actuator": candidate.place[1],
        "parameters": {},
        "rivals": [],
    }


def _answer(stage: StageData, causes: Sequence[CandidateData], left: float) -> Answer:
    place = {"stage": stage.place[0], "actuator": stage.place[1]}
    closure = {"stage": {"value": _closure(stage, left), "low": None, "high": None}, "tip": None}
    return {"status": "attributed", "where": [place], "causes": [_cause(c) for c in causes], "closure": closure}


NO_GAP: Answer = {"status": "no_gap", "where": [], "causes": [], "closure": {}}


def best_rmse(data: BaselineInput) -> Answer:
    """Name the effect whose fit takes most off the residual, in units of the stage's floor."""
    stages = {stage.place: stage for stage in data.stages}

    def gain(candidate: CandidateData) -> float:
        stage = stages[candidate.place]
        return (_energy(stage.nominal) - _energy(candidate.fitted)) / max(stage.floor, 1e-300)

    able = [c for c in data.candidates if c.place in stages]
    if not able:
        return NO_GAP
    best = max(able, key=gain)
    return _answer(stages[best.place], [best], _energy(best.fitted))


def iid_bic(data: BaselineInput) -> Answer:
    """Name the effect with the largest BIC gain, if it is very strong; every sample counts as independent."""
    stages = {stage.place: stage for stage in data.stages}

    def gain(candidate: CandidateData) -> float:
        nominal = stages[candidate.place].nominal
        n = max(2, _samples(nominal))
        ratio = max(_energy(nominal), 1e-300) / max(_energy(candidate.fitted), 1e-300)
        return n * math.log(ratio) - candidate.size * math.log(n)

    able = [c for c in data.candidates if c.place in stages]
    best = max(able, key=gain, default=None)
    if best is None or gain(best) < BIC_GAIN:
        return NO_GAP
    return _answer(stages[best.place], [best], _energy(best.fitted))


def all_parameters(data: BaselineInput) -> Answer:
    """Fit all effects of every stage together, linear about their single fits; name those that iid intervals keep."""
    found: list[tuple[float, CandidateData]] = []
    left: dict[Place, float] = {}
    stages = {stage.place: stage for stage in data.stages}
    for place, stage in stages.items():
        members = [c for c in data.candidates if c.place == place]
        if not members:
            continue
        y = np.concatenate([run.ravel() for run in stage.nominal])
        x = np.column_stack([y - np.concatenate([run.ravel() for run in c.fitted]) for c in members])
        size = np.linalg.norm(x, axis=0)
        members = [c for c, s in zip(members, size, strict=True) if s > 0]
        x = x[:, size > 0]
        if not members:
            continue
        weights, *_ = np.linalg.lstsq(x, y, rcond=1e-8)
        rest = y - x @ weights
        left[place] = float(rest @ rest)
        spread = np.sqrt(left[place] / max(1, len(y) - len(members)) * np.diag(np.linalg.pinv(x.T @ x)))
        part = np.linalg.norm(x * weights, axis=0) / math.sqrt(len(y) * max(stage.floor, 1e-300))
        found += [
            (float(p), c)
            for c, w, s, p in zip(members, weights, spread, part, strict=True)
            if s > 0 and abs(w) > 1.96 * s
        ]
    if not found:
        return NO_GAP
    found.sort(key=lambda item: -item[0])
    place = found[0][1].place
    return _answer(stages[place], [c for _, c in found], left[place])


def lag_of(a: Array, b: Array) -> int:
    """Return the shift of `b` against `a` [samples] of the largest cross-correlation, means kept as SAGE does."""
    n = len(a)
    shifts = range(-MAXIMUM_LAG, MAXIMUM_LAG + 1)
    products = [float(np.dot(a[max(0, -s) : n - max(0, s)], b[max(0, s) : n - max(0, -s)])) for s in shifts]
    return int(shifts[int(np.argmax(products))])


def trace_metrics(data: BaselineInput) -> Answer:
    """Rank joints by RMSE over their travel; call a lag a delay, and everything else a gap without a cause."""
    traces = data.traces
    if traces is None or not traces.measured:
        return NO_GAP
    worst, worst_value, worst_lag = traces.actuators[0], -1.0, 0
    for j, name in enumerate(traces.actuators):
        pairs = [(m[:, j], s[:, j]) for m, s in zip(traces.measured, traces.simulated, strict=True)]
        travel = max(float(np.ptp(m)) for m, _ in pairs)
        rmse = math.sqrt(float(np.mean([np.mean((m - s) ** 2) for m, s in pairs])))
        value = rmse / travel if travel > 0 else 0.0
        if value > worst_value:
            moving = [(m, s) for m, s in pairs if np.ptp(m) > 0]
            lags = [lag_of(s, m) for m, s in moving]
            worst, worst_value, worst_lag = name, value, round(float(np.median(lags))) if lags else 0
    place = {"stage": "transport" if worst_lag > 0 else "motor_mechanics", "actuator": worst}
    answer = {"status": "outside_library", "where": [place], "causes": [], "closure": {}}
    if worst_lag > 0:
        cause = {"effect": "command_delay", "family": "timing", **place, "parameters": {}, "rivals": []}
        answer |= {"status": "attributed", "causes": [cause]}
    return answer


BASELINES: Mapping[str, Callable[[BaselineInput], Answer]] = {
    "best_rmse": best_rmse,
    "iid_bic": iid_bic,
    "all_parameters": all_parameters,
    "trace_metrics": trace_metrics,
}
