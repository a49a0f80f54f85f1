"""The diagnosis of a case: localise, attribute, quantify, or abstain."""

from __future__ import annotations

import importlib.metadata
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from sher3_description import Robot

from sher3_gap.attribute import Attribution, Candidates, attribute
from sher3_gap.audit import audit
from sher3_gap.channels import Channel, unit_of
from sher3_gap.constancy import constancy_of
from sher3_gap.evidence import Evidence, gather
from sher3_gap.exact_causes import ExactFinding, controller_finding, exact_interval, transport_finding
from sher3_gap.fitting import Fit, fit
from sher3_gap.library import LIBRARY
from sher3_gap.loading import load_case
from sher3_gap.localise import Gap, gap_of, localise
from sher3_gap.quantify import closure, excess, parameters, residual_after, samples_of
from sher3_gap.regimes import regime
from sher3_gap.separate import next_experiment
from sher3_gap.signals import RunSignals
from sher3_gap.signature import signature
from sher3_gap.tip import tip_closure
from sher3_gap.verdict import Cause, Closure, Residual, Status, Unexplained, Verdict, Where

Say = Callable[[str], None]
REMAINDER = (0.10, 0.25)
"""Share of a channel's gap that may be left when its cause is known, and the share that may be left if it is also
small: laws are
idealisations."""
SMALL_REMAINDER = 2.5
"""Power over floor of what is left up to which it is small."""
SLIGHT = 1.6
"""Power over threshold below which a gap beside an explained one is taken as spill-over, not as a cause of its own."""
LOST_MOTION = ("backlash", "transmission_hysteresis", "transmission_compliance")
"""Effects between motor and load that show only against a load-side friction: that friction is their companion."""


@dataclass(frozen=True)
class Diagnosis:
    """A verdict with the evidence behind it, for reports and further experiments."""

    verdict: Verdict
    evidence: Evidence
    gaps: list[Gap]
    attribution: Attribution
    exact: list[ExactFinding]


def diagnose(
    case: Path | str, robot: Path | None = None, without: Collection[str] = (), say: Say = lambda _: None
) -> Verdict:
    """Diagnose a case folder; see `diagnose_runs`.

    Raises:
        CaseError: the case cannot be diagnosed; the error names the run, the value and the remedy.
    """
    return diagnose_case(case, robot, without, say).verdict


def diagnose_case(
    case: Path | str, robot: Path | None = None, without: Collection[str] = (), say: Say = lambda _: None
) -> Diagnosis:
    """Diagnose a case folder and keep the evidence."""
    started = time.perf_counter()
    say("reading the bags")
    runs, model = load_case(Path(case), robot)
    notes = audit(runs, model)
    found = diagnose_runs(runs, model, without, say, started)
    verdict = found.verdict.model_copy(update={"notes": [*notes, *found.verdict.notes]})
    return replace(found, verdict=verdict)


def diagnose_runs(
    runs: Sequence[RunSignals],
    robot: Robot,
    without: Collection[str] = (),
    say: Say = lambda _: None,
    started: float | None = None,
) -> Diagnosis:
    """Say where the robot leaves the nominal model, which effects explain it and how far the gap shrinks.

    Args:
        runs: of one robot in one condition, repeats included.
        robot: the nominal model.
        without: effect ids that are left out of the library.
        say: progress.
        started: clock at which the work began, s; now when None.
    """
    started = time.perf_counter() if started is None else started
    unknown = set(without) - LIBRARY.keys()
    if unknown:
        raise ValueError(f"no such effect: {', '.join(sorted(unknown))}; effects are {', '.join(LIBRARY)}")
    say("simulating the nominal robot")
    evidence = gather(runs, robot)
    gaps = localise(evidence)
    found = (transport_finding(evidence.timing, runs, robot, without), controller_finding(runs, robot, without))
    exact = [f for f in found if f is not None]
    initial = {g.channel: g for g in gaps if g.significant}
    attribution = attribute(evidence, lambda f: left_over(evidence, initial, f), Candidates(evidence, without), say)
    say("quantifying")
    verdict = _verdict(evidence, initial, attribution, exact)
    versions = {p: importlib.metadata.version(p) for p in ("sher3", "numpy", "scipy")}
    verdict = verdict.model_copy(update={"seconds": time.perf_counter() - started, "versions": versions})
    return Diagnosis(verdict, evidence, gaps, attribution, exact)


def left_over(evidence: Evidence, initial: dict[Channel, Gap], current: Fit) -> dict[Channel, float]:
    """Gaps that remain under a fit: channel -> excess loss. What is left of a gap may be `REMAINDER` of it."""
    out: dict[Channel, float] = {}
    for channel in initial:
        gap = gap_of(evidence, channel, residual_after(evidence, current, channel))
        if gap is None or not gap.significant:
            continue
        now, null = excess(evidence, channel, current), excess(evidence, channel)
        small = now < SMALL_REMAINDER * samples_of(evidence, channel)
        allowed = REMAINDER[1] if small else REMAINDER[0]
        if null <= 0.0 or now > allowed * null:
            out[channel] = max(now, 1.0)
    return out


def _verdict(
    evidence: Evidence, initial: dict[Channel, Gap], attribution: Attribution, exact: list[ExactFinding]
) -> Verdict:
    causes = [_cause(evidence, attribution, i) for i in range(len(attribution.fit.terms))]
    where = _where(evidence, initial, attribution)
    open_ = left_over(evidence, initial, attribution.fit)
    if causes or exact:
        slight = {c for c in open_ if initial[c].power < SLIGHT}
        initial = {c: g for c, g in initial.items() if c not in slight}
        open_ = {c: x for c, x in open_.items() if c not in slight}
    if not initial and not exact:
        return Verdict(status="no_gap")
    causes = _order([*(c for f in exact for c in f.causes), *causes])
    where = [f.where for f in exact] + where
    unexplained = _unexplained(evidence, open_, attribution, exact)
    experiment = next_experiment(evidence, attribution)
    crossed = any(_crossing(c) for c in causes)
    status: Status
    if unexplained is not None:
        status = "outside_library"
    elif crossed and experiment is not None:
        status = "under_excited"
    else:
        status = "attributed"
    first = _first_channel(evidence, initial, where[0])
    stage = exact_interval(exact[0].closure) if exact else None
    residual = Residual(gap=exact[0].where.floor, floor=exact[0].where.floor, unit="m/s") if exact else None
    if first is not None and not exact:
        stage = closure(evidence, first, fit(evidence.data, []), attribution.fit)
        residual = _residual(evidence, first, attribution.fit)
    return Verdict(
        status=status,
        where=where,
        causes=causes,
        closure=Closure(stage=stage, tip=tip_closure(evidence, causes, attribution.fit)),
        residual=residual,
        unexplained=unexplained,
        next_experiment=experiment,
    )


def _crossing(cause: Cause) -> bool:
    """Whether a rival is of another family; an effect that the cause contains was found to explain markedly less."""
    others = set(cause.rivals) - set(LIBRARY[cause.effect].extends) if cause.effect in LIBRARY else set()
    return any(LIBRARY[r].family != cause.family for r in others)


def _cause(evidence: Evidence, attribution: Attribution, index: int) -> Cause:
    term = attribution.fit.terms[index]
    without = fit(evidence.data, [t for j, t in enumerate(attribution.fit.terms) if j != index])
    shows = [c for c in term.channels if excess(evidence, c) > 0.0] or list(term.channels)
    channel = max(shows, key=lambda c: excess(evidence, c, without) - excess(evidence, c, attribution.fit))
    rivals = [f.terms[-1].effect.id for f in attribution.rivals[index]]
    return Cause(
        effect=term.effect.id,
        family=term.effect.family,
        stage=_stage_of(term.effect.id, channel),
        actuator=term.site,
        parameters=parameters(evidence, attribution.fit, index),
        closure=closure(evidence, channel, without, attribution.fit),
        rivals=list(dict.fromkeys(rivals)),
    )


def _stage_of(effect: str, channel: Channel) -> str:
    stage = LIBRARY[effect].stage
    return channel.stage if effect == "cable_drag" else stage


def _order(causes: list[Cause]) -> list[Cause]:
    """Most closure first; the friction behind a lost motion after the lost motion."""
    behind = {c.actuator for c in causes if c.effect in LOST_MOTION}
    follows = lambda c: c.family == "friction" and c.actuator in behind  # noqa: E731
    return sorted(causes, key=lambda c: (follows(c), -round(c.closure.value, 2)))


def _where(evidence: Evidence, initial: dict[Channel, Gap], attribution: Attribution) -> list[Where]:
    """Places with a gap, largest gap over floor first; those of a lost motion's companion after it."""
    behind = {t.site for t in attribution.fit.terms if t.effect.id in LOST_MOTION}
    entries = []
    for channel, gap in initial.items():
        follows = channel.stage == "motor_mechanics" and channel.actuator in behind
        actuator = _actuator(channel, attribution)
        entries.append(
            (
                follows,
                -gap.ratio,
                Where(
                    stage=_place(channel, attribution),
                    actuator=actuator,
                    gap=gap.gap,
                    floor=gap.floor,
                    unit=unit_of(channel),
                    regime=regime(evidence, channel),
                    confidence=float(1.0 - np.exp(-gap.power)),
                ),
            )
        )
    return [w for _, _, w in sorted(entries, key=lambda e: e[:2])]


def _terms_at(channel: Channel, attribution: Attribution) -> list:
    return [t for t in attribution.fit.terms if channel in t.effect.channels(t.site)]


def _actuator(channel: Channel, attribution: Attribution) -> str:
    """At the tip, the actuator whose effect explains the gap there."""
    terms = _terms_at(channel, attribution)
    return terms[0].site if channel.actuator == "tip" and terms else channel.actuator


def _place(channel: Channel, attribution: Attribution) -> str:
    """The tip is one reading: a gap there belongs to the stage of the effect that explains it."""
    terms = _terms_at(channel, attribution)
    if channel.actuator == "tip" and terms and terms[0].effect.stage in ("mechanism", "structure"):
        return terms[0].effect.stage
    return channel.stage


def _first_channel(evidence: Evidence, initial: dict[Channel, Gap], where: Where) -> Channel | None:
    return next((c for c, g in initial.items() if g.gap == where.gap), None)


def _residual(evidence: Evidence, channel: Channel, after: Fit) -> Residual:
    gap = gap_of(evidence, channel, residual_after(evidence, after, channel))
    assert gap is not None
    return Residual(gap=gap.gap, floor=gap.floor, unit=unit_of(channel))


def _unexplained(
    evidence: Evidence, open_: dict[Channel, float], attribution: Attribution, exact: list[ExactFinding]
) -> Unexplained | None:
    for finding in exact:
        if finding.closure < 0.9:
            return Unexplained(
                stage=finding.where.stage,
                actuator=finding.where.actuator,
                signature=f"an exact stage is not reproduced: {finding.note or 'no timing or gain error fits'}",
            )
    if not open_:
        return _inconstant(evidence, attribution)
    channel = max(open_, key=lambda c: open_[c])
    return Unexplained(
        stage=channel.stage, actuator=channel.actuator, signature=signature(evidence, channel, attribution.fit)
    )


def _inconstant(evidence: Evidence, attribution: Attribution) -> Unexplained | None:
    """A cause whose size differs between excitations stands in for an effect the library does not have."""
    for i, term in enumerate(attribution.fit.terms):
        found = constancy_of(evidence, attribution.fit, i)
        if not found.constant:
            channel = max(term.channels, key=lambda c: excess(evidence, c))
            return Unexplained(
                stage=channel.stage,
                actuator=channel.actuator,
                signature=f"{term.effect.id} fits, but not with one size in all excitations "
                f"({found.spread:.1%} of what it explains differs); {signature(evidence, channel, attribution.fit)}",
            )
    return None
