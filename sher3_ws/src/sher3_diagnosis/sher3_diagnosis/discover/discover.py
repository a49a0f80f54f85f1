"""Discovery: a sparse formula for the gap at a place, found on some runs and scored on the others."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from sher3_common.progress import Say, silent

from sher3_diagnosis.channel import AT_TIP, Array, Channel
from sher3_diagnosis.discover.ceiling import predicted
from sher3_diagnosis.discover.columns import Columns, Recorded, columns
from sher3_diagnosis.discover.dictionary import Group, dictionary
from sher3_diagnosis.discover.feature import Feature, FormulaError
from sher3_diagnosis.discover.formula import Discovery, FoundTerm
from sher3_diagnosis.discover.search import Search
from sher3_diagnosis.discover.sentence import sentence
from sher3_diagnosis.discover.spectrum import suggestions
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Findings
from sher3_diagnosis.judge.left_over import down_to_floor
from sher3_diagnosis.quantify.closure import interval_of
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE, LEAST_COMPONENT, MIN_RUNS, SMALL_REMAINDER
from sher3_diagnosis.verdict import Interval, Parameter

FOLDS = 3
"""Folds: each holds repeats of what the others have too, and whatever was recorded once only in one of them."""
Formula = list[tuple[int, Feature, float]]
"""Component, feature and coefficient of every term."""


def discover(diagnosis: Findings, channel: Channel | None = None, say: Say = silent) -> Discovery:
    """Find a formula for the gap that no effect of the library explains.

    Args:
        diagnosis: of any machine whose views tell what was recorded (`Recorded`).
        channel: where to look; default the place the verdict leaves unexplained, else where its causes leave most.
        say: takes a line of progress.

    Raises:
        FormulaError: the machine has no such channel, or its views do not tell what was recorded.
    """
    left = diagnosis.verdict.unexplained
    if channel is None and left is not None:
        channel = Channel(left.stage, left.actuator)
    channel = _left_most(diagnosis) if channel is None else channel
    if channel is None:
        why = "there is no gap" if diagnosis.verdict.status == "no_gap" else "every gap has a cause in the library"
        return Discovery([], note=f"nothing to discover: {why}")
    exact = next((e.evidence for e in diagnosis.exact if e.where.stage == channel.stage and e.evidence), None)
    if exact is not None:
        return _discover_exactly(exact(), channel, say)
    channel = _showing_channel(diagnosis, channel)
    known = sorted({str(c) for f in diagnosis.findings for c in f.evidence.channels})
    finding = next((f for f in diagnosis.findings if channel in f.evidence.channels), None)
    if finding is None:
        remedy = "name a place with a gap"
        raise FormulaError("no formula can be found there", value=str(channel), limit=", ".join(known), remedy=remedy)
    if channel not in finding.significant:
        return Discovery([channel], note=f"nothing to discover: {channel} is at its floor")
    if not all(isinstance(v, Recorded) for v in finding.evidence.views):
        raise FormulaError(
            "this kind of machine does not tell what a law could depend on",
            value=str(channel),
            remedy="a formula is found on axes, servos, arms in motion and the SHER",
        )
    return discover_at(finding.evidence, channel, say)


def _left_most(diagnosis: Findings) -> Channel | None:
    """Return the channel of which its causes leave most over the floor; None where they leave little everywhere.

    A relative of the right law may close a gap so far that nothing is called unexplained.
    """
    over: dict[Channel, float] = {}
    for f in diagnosis.findings:
        left = down_to_floor(f.significant, f.evidence, f.attribution.fit)
        over |= {channel: excess / f.evidence.samples(channel) for channel, excess in left.items()}
    most = max(over, key=lambda c: over[c], default=None)
    return most if most is not None and over[most] > SMALL_REMAINDER else None


def _discover_exactly(evidence: Evidence, place: Channel, say: Say) -> Discovery:
    """Find a formula for the error of an exact stage on one axis; where all have it, on the axis that shows it most.

    That axis has the largest share of ticks that are off: the sizes of an error cannot be compared between axes that
    turn and axes that slide.
    """
    if place in evidence.channels:
        return discover_at(evidence, place, say)
    if place.actuator != "all":
        return Discovery([place], note=f"nothing to discover: {place} does what it is asked to")
    off = {
        c: np.mean([np.mean(r[c].values[r[c].ok] != 0.0) for r in evidence.data.residuals]) for c in evidence.channels
    }
    return discover_at(evidence, max(off, key=lambda c: off[c]), say)


def _showing_channel(diagnosis: Findings, place: Channel) -> Channel:
    """Return the channel that shows a place: a leg of the mechanism shows at the tip."""
    every = {c for f in diagnosis.findings for c in f.evidence.channels}
    same = [c for c in every if c.stage == place.stage]
    return same[0] if place not in every and len(same) == 1 else place


def discover_at(evidence: Evidence, channel: Channel, say: Say = silent) -> Discovery:
    """Find a formula for the gap of a channel.

    Args:
        evidence: of the part the channel belongs to; its views tell what was recorded (`Recorded`).
        channel: where the gap is; at a tip its loaded and unloaded samples are explained together.
        say: takes a line of progress.
    """
    channels = [c for c in evidence.channels if c == channel or {c.stage, channel.stage} <= set(AT_TIP)]
    channels.sort(key=lambda c: c != channel)
    evidence = wholly_determined(evidence, channels)
    target = evidence.data.target
    shown = sum(any(c in t for c in channels) for t in target)
    if shown < MIN_RUNS:
        return Discovery(channels, note=f"{shown} runs show {channel}, too few to leave some out: record {MIN_RUNS}")
    found = columns(evidence, channels, target)
    parts = folds(found.evidence.excitations)
    components = _with_gap(found)
    say("evaluating the dictionary")
    search = partial(_search, found, *_dictionary(found))
    everything = range(len(found.target))
    say("searching the formula")
    formula = search(everything, components)
    guesses, sparse = _zeros(found), _zeros(found)
    again: list[Formula] = []
    for k, fold in enumerate(parts):
        say(f"scoring on runs left out, {k + 1} of {len(parts)}")
        again.append(search([r for r in everything if r not in fold], components))
        for r in fold:
            sparse[r] += _predicted(found, r, again[-1])
    say("fitting boosted trees, the ceiling")
    for component in components:
        for r, values in enumerate(predicted(found, component, parts)):
            guesses[r][:, component] = values
    closure, ceiling = _closure(found, sparse), _closure(found, guesses)
    if not formula or closure.low is None or closure.low <= 0.0:
        return Discovery(channels, ceiling=ceiling, folds=len(parts), note="no formula holds on runs left out")
    terms = _terms(found, formula, again)
    sentences = [sentence(t, channel, found.quantities[0]) for t in terms]
    return Discovery(channels, terms, closure, ceiling, sentences, len(parts))


def wholly_determined(evidence: Evidence, channels: Sequence[Channel]) -> Evidence:
    """Return the evidence without the samples of these channels that tell a part alone: their inputs are not known."""
    residuals = [
        {c: x.wholly_determined() if c in channels else x for c, x in run.items()} for run in evidence.data.residuals
    ]
    data = type(evidence.data)(evidence.data.views, residuals, evidence.floors)
    return Evidence(evidence.excitations, data, evidence.units, evidence.places)


def _with_gap(found: Columns) -> list[int]:
    """Components that hold a share of the gap worth looking at."""
    samples = sum(len(t) for t in found.target)
    excess = np.sum([np.sum(t**2, axis=0) for t in found.target], axis=0) - samples
    return [k for k in range(found.width) if excess[k] > LEAST_COMPONENT * max(excess.max(), 0.0)]


def _dictionary(found: Columns) -> tuple[list[Group], list[Array], list[Array]]:
    groups = dictionary(found.quantities, found.evidence.unit(found.channels[0]), found.views[0].step)
    features = [f for g in groups for f in g]
    designs = [found.design(r, features) for r in range(len(found.target))]
    return groups, designs, [x.T @ x for x in designs]


def _search(
    found: Columns,
    groups: list[Group],
    designs: list[Array],
    normals: list[Array],
    runs: Sequence[int],
    components: Sequence[int],
) -> Formula:
    """Return the formula of every component, from some runs alone."""
    out: Formula = []
    for component in components:
        one = Search(found, component, list(runs), designs, normals, groups)
        features = one.run(partial(suggestions, found, list(runs), component)).features
        if features:
            values = one.moments(features).coefficients(range(len(features)))
            out += [(component, f, float(v)) for f, v in zip(features, values, strict=True)]
    return out


def _zeros(found: Columns) -> list[Array]:
    return [np.zeros_like(t) for t in found.target]


def _predicted(found: Columns, run: int, formula: Formula) -> Array:
    """Return what a formula makes of a run, standardised (N, d)."""
    out = np.zeros_like(found.target[run])
    for component, feature, value in formula:
        out[:, component] += found.design(run, [feature])[:, 0] * value / found.floor(run, component)
    return out


def _closure(found: Columns, added: Sequence[Array]) -> Interval:
    """Closure of the standardised gap, all components together, by predictions for runs left out."""
    rows = [[np.mean(t**2), np.mean((t - p) ** 2), 1.0] for t, p in zip(found.target, added, strict=True)]
    return interval_of(np.array(rows))


def _terms(found: Columns, formula: Formula, again: Sequence[Formula]) -> list[FoundTerm]:
    """Terms with intervals from a jackknife over runs, largest part of the gap first."""
    out: list[tuple[float, FoundTerm]] = []
    for component in dict.fromkeys(c for c, _, _ in formula):
        features = [f for c, f, _ in formula if c == component]
        search = Search(found, component, list(range(len(found.target))), [], [], [])
        moments = search.moments(features)
        every = range(len(features))
        best = moments.coefficients(every)
        draws = np.array([moments.without(r).coefficients(every) for r in range(len(found.target))])
        half = JACKKNIFE * standard_error(draws)
        energy = np.einsum("rii->i", moments.normal) * best**2
        for i, f in enumerate(features):
            unit = f.unit(found.units, found.evidence.unit(found.channels[0], component // 3))
            value = Parameter(value=best[i], low=best[i] - half[i], high=best[i] + half[i], unit=unit)
            times = sum(any(c == component and alike(f, g) for c, g, _ in fold) for fold in again)
            out.append((float(energy[i]), FoundTerm(f, component, value, times)))
    return [t for _, t in sorted(out, key=lambda x: -x[0])]


def alike(one: Feature, other: Feature) -> bool:
    """Return whether two features have the same laws of the same quantities."""
    return [(f.law, f.quantity) for f in one.factors] == [(f.law, f.quantity) for f in other.factors]


def folds(excitations: Sequence[str]) -> list[list[int]]:
    """Return the runs of every fold: repeats of one excitation are dealt to different folds."""
    order = sorted(range(len(excitations)), key=lambda r: (excitations[r], r))
    return [sorted(order[k::FOLDS]) for k in range(min(FOLDS, len(order)))]
