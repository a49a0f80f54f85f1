"""A calibration from observations: logistic models held down by a ridge, sets of rivals from a conformal quantile."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from scipy.optimize import minimize, minimize_scalar
from scipy.special import softmax
from sher3_diagnosis.finding import LIBRARY, NO_GAP, OUTSIDE
from sher3_diagnosis.judge.calibration.calibration import Calibration, Provenance
from sher3_diagnosis.judge.calibration.logistic import Logistic
from sher3_diagnosis.judge.calibration.typical import Typical, distance
from sher3_diagnosis.judge.evidence.scales import scaled_cause, scaled_exact, scaled_gap

from sher3_challenge.calibration.labels import answer_of, equal, known_effects
from sher3_challenge.calibration.observe import Observation
from sher3_challenge.errors import ChallengeError

QUANTILES = 41
"""Distances that say how unusual evidence is: steps of 2.5 %."""
COVERAGE = 0.97
"""Share of cases whose true effect the set of rivals is to hold."""
SAME_DATA_CROSSING = 0.5
"""Unlikeness up to which another effect gives the same data: always a rival, and of another family one that leaves the
cause open."""
RIDGE = 2.0
"""Weight of the squared coefficients beside the log likelihood of all examples: a coefficient is expected to be within
0.5 of nothing, on inputs with a spread of one. Set on: the plants other than the one quoted."""
EVEN = 0.01
"""The same of the constants: no answer is impossible because no case had it."""
READ = ("left", "complete", "floors", "foreign", "spread", "mismatch", "size")
"""Evidence that the model of a cause reads. What a free law of its own inputs leaves (`law`) is not read by itself, for
it told nothing more of plants left out."""
FEW = 10
"""Examples of a plant up to which each counts the same: a lone one must not speak for its plant."""
FOREIGN = {OUTSIDE: 0.4}
"""Weight of a cause whose answer lies outside: of the labelled causes two in five do, for each single fault is judged
without its effect once more, and in use fewer. Of 0.3, 0.4, 0.5 and 0.6 the largest by which no more right causes are
called outside on plants left out than by the weights before (14 of 159; 13, 14, 15 and 17); effects left out are blamed
in 14, 12, 8 and 4 of 115 (15 before)."""
LAST = frozenset({"size"})
"""Evidence that only says that a gap is one: how large it is tells nothing of its cause."""


@dataclass(frozen=True)
class Example:
    """One item with its right answer and the plant it is of."""

    plant: str
    numbers: Mapping[str, float]
    answer: str


PLAIN = 5 * [
    Example("by argument", scaled_exact(1.0), LIBRARY),
    Example("by argument", scaled_exact(0.5), OUTSIDE),
]
"""Exact stages whose answer needs no case: causes that reproduce the whole error to rounding, and half of it."""
ECHOES = 3 * [
    Example("by argument", scaled_gap({"power": 1.0, "beside": 4.0}), NO_GAP),
    Example("by argument", scaled_gap({"power": 4.5, "beside": 0.0}), OUTSIDE),
    Example("by argument", scaled_gap({"power": 2.0, "beside": 0.0}), NO_GAP),
]
"""Gaps whose answer needs no case: one at its threshold beside one of its place fifty times as large; one of three
floors, nine times the floor's power and half as much over its threshold; and one of two floors: of a healthy robot's
many channels some are above their threshold."""

SWAPPED = [*(5 * [(0.0, [0.0, 1.0])]), (1.0, [0.0, 1.0])]
"""Pairs of effects, one at the margin of a rival (unlikeness 1), whose answer needs no case: five to one for the
closer. Few cases hold a close rival at all, and such cases would call the second impossible. The calibration before
this one, on 186 cases, had a sharpness of 1.71 and a reach of 0.95; five to one alone is 1.61."""


@dataclass(frozen=True)
class Examples:
    """What a calibration is fitted to.

    Attributes:
        causes, gaps, exact: items with their answers.
        distances: per cause whose true effect is among its candidates, the unlikeness of that effect, and of all.
    """

    causes: list[Example]
    gaps: list[Example]
    exact: list[Example]
    distances: list[tuple[float, list[float]]]


def examples_of(observations: Sequence[Observation]) -> Examples:
    """Return the items of observations that their labels settle."""
    whole = {(o.plant, o.case): o for o in observations if not o.without}
    out = Examples([], [], [], [])
    for seen in observations:
        for item in seen.items:
            answer = answer_of(seen, item, whole[seen.plant, seen.case])
            if answer is None:
                continue
            if item["index"] is None:
                out.gaps.append(Example(seen.plant, scaled_gap(item["numbers"]), answer))
                continue
            out.causes.append(Example(seen.plant, scaled_cause(item["numbers"]), answer))
            far = [c["unlikeness"] for c in item["candidates"] if equal(c["effect"], known_effects(seen))]
            if answer == LIBRARY and far:
                out.distances.append((min(far), [c["unlikeness"] for c in item["candidates"]]))
        for stage in seen.exact:
            right = bool(stage["causes"]) and {c["effect"] for c in stage["causes"]} <= known_effects(seen)
            if stage["causes"]:
                numbers = scaled_exact(stage["closure"])
                out.exact.append(Example(seen.plant, numbers, LIBRARY if right else OUTSIDE))
    return out


def updated(before: Calibration, observations: Sequence[Observation]) -> Calibration:
    """Return a calibration whose weights are expected to be those of before, and are set on observations beside them.

    What few cases cannot set is kept: exact stages, sharpness and reach.
    """
    seen = examples_of(observations)
    cause = logistic(seen.causes, before.cause.classes, before.cause.inputs, FOREIGN, before.cause)
    gap = logistic([*seen.gaps, *ECHOES], before.gap.classes, before.gap.inputs, before=before.gap)
    records = (*before.provenance, *provenance(observations, seen))
    found = {"cause": cause, "gap": gap, "typical": typical(cause, seen.causes), "provenance": records}
    return before.model_copy(update=found)


def calibrated(observations: Sequence[Observation]) -> Calibration:
    """Fit a calibration."""
    seen = examples_of(observations)
    cause = logistic(seen.causes, (LIBRARY, OUTSIDE, NO_GAP), READ, FOREIGN)
    return Calibration(
        cause=cause,
        gap=logistic([*seen.gaps, *ECHOES], (NO_GAP, OUTSIDE), ("power", "alone")),
        exact=logistic([*seen.exact, *PLAIN], (LIBRARY, OUTSIDE), ("missed",)),
        sharpness=sharpness([*seen.distances, *SWAPPED]),
        reach=max(conformal([d for d, _ in [*seen.distances, *SWAPPED]], COVERAGE), SAME_DATA_CROSSING),
        coverage=COVERAGE,
        same=SAME_DATA_CROSSING,
        typical=typical(cause, seen.causes),
        provenance=provenance(observations, seen),
    )


def provenance(observations: Sequence[Observation], seen: Examples) -> tuple[Provenance, ...]:
    """Return where observations and their examples came from, plant by plant."""
    plants = sorted({o.plant for o in observations})
    return tuple(
        Provenance(
            plant=p,
            cases=len({o.case for o in observations if o.plant == p}),
            causes=sum(e.plant == p for e in seen.causes),
            gaps=sum(e.plant == p for e in seen.gaps),
            built=ends(observations, p, "built"),
            shape=ends(observations, p, "shape"),
        )
        for p in plants
    )


def ends(observations: Sequence[Observation], plant: str, name: str) -> tuple[float, float] | None:
    """Return the least and the largest level of a plant's robots; None where its labels do not say."""
    levels = [o.truth["level"][name] for o in observations if o.plant == plant and "level" in o.truth]
    return (min(levels), max(levels)) if levels else None


def placed_among(calibration: Calibration, observations: Sequence[Observation]) -> Calibration:
    """Return a calibration with its weights, that tells what is unusual by the causes of these observations."""
    seen = examples_of(observations).causes
    return calibration.model_copy(update={"typical": typical(calibration.cause, seen)})


def typical(model: Logistic, examples: Sequence[Example]) -> Typical:
    """Return where examples lie; a covariance is over those that have both inputs. Raises ChallengeError of none."""
    if not examples:
        raise ChallengeError("no evidence of a cause", value=0, limit=1, remedy="more cases, or more --minutes")
    x = np.array([model.scaled(e.numbers) for e in examples])
    both = np.isfinite(x).T.astype(float) @ np.isfinite(x)
    covariance = np.nan_to_num(x).T @ np.nan_to_num(x) / np.maximum(both, 1.0)
    far = np.quantile([distance(row, covariance) for row in x], np.linspace(0.0, 1.0, QUANTILES))
    return Typical(
        covariance=tuple(map(tuple, covariance.tolist())), distances=tuple(far.tolist()), causes=len(examples)
    )


def logistic(
    examples: Sequence[Example],
    classes: Sequence[str],
    inputs: Sequence[str],
    share: Mapping[str, float] = MappingProxyType({}),
    before: Logistic | None = None,
) -> Logistic:
    """Fit a logistic model with a ridge in which every plant has the same weight.

    The first class is the one that the inputs speak against, the second the one they speak for: weights of the other
    sign are none, so that chance in one plant's cases cannot turn evidence round on the next. An input of `LAST` speaks
    against the last class alone. A number that an example lacks is at its middle, where it tells nothing. `share` is
    the weight of an answer's examples, 1 where it names none. With a model of before, of the same classes and inputs,
    the scale of the inputs is its own, and its weights are expected instead of none.

    Raises:
        ChallengeError: all examples have one answer.
    """
    x = np.array([[e.numbers.get(name, math.nan) for name in inputs] for e in examples], dtype=float)
    x = x.reshape(len(examples), len(inputs))
    y = np.array([[e.answer == name for name in classes] for e in examples], dtype=float).reshape(-1, len(classes))
    if (y.sum(axis=0) > 0.0).sum() < (2 if before is None else 1):  # weights of before know both kinds
        raise ChallengeError("cases of one kind only", value=len(examples), limit=2, remedy="healthy and foreign ones")
    known = np.isfinite(x)
    count = np.maximum(known.sum(axis=0), 1)
    middle = np.where(known, x, 0.0).sum(axis=0) / count if before is None else np.array(before.middle)
    z = np.where(known, x - middle, 0.0)
    spread = np.maximum(np.sqrt((z**2).sum(axis=0) / count), 1e-9) if before is None else np.array(before.spread)
    z, shares = z / spread, weights(examples, share) / len(examples)
    shape, ridge, even = (len(classes), len(inputs) + 1), RIDGE / len(examples), EVEN / len(examples)
    expected = np.zeros(shape) if before is None else np.column_stack([before.weights, before.offset])

    held = np.hstack([np.full((shape[0], shape[1] - 1), ridge), np.full((shape[0], 1), even)])

    def loss(flat: np.ndarray) -> tuple[float, np.ndarray]:
        w = flat.reshape(shape)
        score = z @ w[:, :-1].T + w[:, -1]
        share = softmax(score, axis=1)
        error = shares[:, None] * (share - y)
        off = w - expected
        slope = np.hstack([error.T @ z, error.sum(axis=0)[:, None]]) + 2.0 * held * off
        likely = float(np.sum(shares * np.log(np.sum(share * y, axis=1) + 1e-300)))
        return float(np.sum(held * off**2)) - likely, slope.ravel()

    bounds = [b for k in range(len(classes)) for b in [*(_bound(n, k, len(classes)) for n in inputs), (None, None)]]
    found = minimize(loss, expected.ravel(), jac=True, bounds=bounds, method="L-BFGS-B").x.reshape(shape)
    return Logistic(
        classes=tuple(classes),
        inputs=tuple(inputs),
        middle=tuple(middle.tolist()),
        spread=tuple(spread.tolist()),
        weights=tuple(tuple(w) for w in found[:, :-1].tolist()),
        offset=tuple(found[:, -1].tolist()),
    )


def _bound(name: str, k: int, classes: int) -> tuple[float | None, float | None]:
    """Return the least and the largest weight that an input may have for class k."""
    if name in LAST:
        return (None, 0.0) if k == classes - 1 else (0.0, 0.0)
    return ((None, 0.0), (0.0, None), (None, None))[min(k, 2)]


def weights(examples: Sequence[Example], share: Mapping[str, float] = MappingProxyType({})) -> np.ndarray:
    """Return weights, 1 on average, by which every plant counts the same once it has `FEW` examples.

    Those of an answer that `share` names count for that much.
    """
    plants = [e.plant for e in examples]
    found = np.array([share.get(e.answer, 1.0) / max(plants.count(e.plant), FEW) for e in examples])
    return found / found.mean()


def sharpness(distances: Sequence[tuple[float, list[float]]]) -> float:
    """Return the fall of a candidate's probability with its unlikeness that makes the true ones most probable."""

    def surprise(log_rate: float) -> float:
        rate = math.exp(log_rate)
        return sum(rate * d + math.log(sum(math.exp(-rate * x) for x in all_)) for d, all_ in distances)

    found = minimize_scalar(surprise, bounds=(math.log(0.1), math.log(30.0)), method="bounded")
    return float(math.exp(found.x))


def conformal(scores: Sequence[float], coverage: float) -> float:
    """Return the score below which a new one lies with the coverage at least: the ceil((n + 1) c)-th smallest."""
    ranked = sorted(scores)
    return ranked[min(len(ranked), math.ceil((len(ranked) + 1) * coverage)) - 1]
