"""The verdict: status, places, causes and what is left, from the findings on every part of a machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sher3_diagnosis.attribute.steadiness import steadiness_of
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.effect import Effect
from sher3_diagnosis.finding import ExactFinding, Finding
from sher3_diagnosis.judge.calibration.calibration import Calibration, in_force
from sher3_diagnosis.judge.causes import ordered, places_of
from sher3_diagnosis.judge.costs import DEFAULT, LIBRARY, NO_GAP, OUTSIDE, Costs
from sher3_diagnosis.judge.next_experiment import next_experiment
from sher3_diagnosis.judge.probabilities import probabilities_of, reproduced
from sher3_diagnosis.judge.remainder import remainder
from sher3_diagnosis.judge.status import answer_to_exact, combined, status_of
from sher3_diagnosis.localise.gaps import Gap, component_rms
from sher3_diagnosis.machine import Machine, Policy
from sher3_diagnosis.quantify.closure import closure, residual_after
from sher3_diagnosis.thresholds import REPRODUCED, SLIGHT
from sher3_diagnosis.verdict import Cause, Closure, Interval, Residual, Status, Unexplained, Verdict, Where

Gaps = dict[Channel, Gap]


def judge(
    machine: Machine,
    findings: Sequence[Finding],
    exact: Sequence[ExactFinding],
    notes: list[str],
    costs: Costs = DEFAULT,
) -> Verdict:
    """Build the verdict of a machine from what was found on its parts and in its exact stages."""
    calibration = in_force() if machine.policy.calibrated else None
    causes = [c for f in exact for c in _probable(f, calibration)] + [c for f in findings for c in f.causes]
    explained = bool(causes or exact)
    within = [w for f in findings for w in machine.within(f)]
    gaps = [_own_gaps(machine.policy, f, explained) for f in findings]
    if not any(gaps) and not exact:
        likely = _probabilities(findings, exact, calibration)
        stated = {} if calibration is None else costs.as_dict()
        return Verdict(status="no_gap", probabilities=likely, costs=stated, within_tolerance=within, notes=notes)
    causes = ordered(causes, list(findings))
    fitted = [w for f in findings for w in places_of(f, f.significant)]
    where = [f.where for f in exact] + (fitted if len(findings) == 1 else sorted(fitted, key=lambda w: -_ratio(w)))
    stage, residual = _first(findings, gaps, exact, where[0].gap)
    unexplained = _unexplained(machine.policy, findings, gaps, exact, calibration, costs)
    proposals = [p for f in findings if (p := next_experiment(f.evidence, f.attribution)) is not None]
    by_rules = {LIBRARY if unexplained is None else OUTSIDE}
    return Verdict(
        status=combined(by_rules, bool(proposals) and _poor(machine, causes))
        if calibration is None
        else _status(findings, exact, calibration, costs),
        where=where,
        causes=causes,
        closure=Closure(stage=stage, tip=machine.end_to_end(findings, causes)),
        residual=residual,
        unexplained=unexplained,
        next_experiment=proposals[0] if proposals else None,
        within_tolerance=within,
        probabilities=_probabilities(findings, exact, calibration),
        costs={} if calibration is None else costs.as_dict(),
        notes=notes,
    )


def _probable(stage: ExactFinding, calibration: Calibration | None) -> list[Cause]:
    """Return the causes of an exact stage with the probability that they are the true ones."""
    if calibration is None:
        return list(stage.causes)
    known = reproduced(stage, calibration)
    return [c.model_copy(update={"probability": known}) for c in stage.causes]


def _probabilities(
    findings: Sequence[Finding], exact: Sequence[ExactFinding], calibration: Calibration | None
) -> dict[str, float]:
    """Return the answers' probabilities; none for a machine of a kind that the calibration was not set on."""
    if calibration is None:
        return {}
    items = [j for f in findings for j in f.judged]
    return probabilities_of(items, exact, calibration) or {NO_GAP: 1.0}


def _status(
    findings: Sequence[Finding], exact: Sequence[ExactFinding], calibration: Calibration, costs: Costs
) -> Status:
    """Return the status that follows from odds and costs."""
    items = [j for f in findings for j in f.judged]
    return status_of(items, [reproduced(e, calibration) for e in exact], calibration.same, costs)


def _poor(machine: Machine, causes: Sequence[Cause]) -> bool:
    """Whether, by the rules, the runs are too poor to tell a cause from one of another family."""
    library = {e.id: e for e in machine.library()}
    return any(_crossing(library, c) for c in causes)


def _ratio(where: Where) -> float:
    return where.gap / max(where.floor, np.finfo(float).tiny)


def _slight(finding: Finding) -> set[Channel]:
    """Channels whose gap is left and so slight that it may be spill-over from an explained one."""
    return {c for c in finding.left if finding.significant[c].power < SLIGHT}


def _own_gaps(policy: Policy, finding: Finding, explained: bool) -> Gaps:
    """Gaps that ask for a cause of their own."""
    spilt = _slight(finding) if policy.spill_over and explained else set()
    return {c: g for c, g in finding.significant.items() if c not in spilt}


def _first(
    findings: Sequence[Finding], gaps: Sequence[Gaps], exact: Sequence[ExactFinding], size: float
) -> tuple[Interval | None, Residual | None]:
    """Closure and remainder at the first place of the verdict, whose gap is `size`."""
    if exact:
        return exact[0].closure, exact[0].residual
    for finding, own in zip(findings, gaps, strict=True):
        channel = next((c for c, g in own.items() if g.gap == size), None)
        if channel is not None:
            evidence, after = finding.evidence, finding.attribution.fit
            gap = own[channel]
            left = component_rms(residual_after(evidence, after, channel), gap.component)
            residual = Residual(gap=left, floor=gap.floor, unit=evidence.unit(channel, gap.component))
            return closure(evidence, channel, evidence.null(), after), residual
    return None, None


def _unexplained(
    policy: Policy,
    findings: Sequence[Finding],
    gaps: Sequence[Gaps],
    exact: Sequence[ExactFinding],
    calibration: Calibration | None,
    costs: Costs,
) -> Unexplained | None:
    """What is left that no effect explains: in an exact stage, of a gap, or as a cause that changes its size."""
    for stage in exact:
        if not _reproduced(stage, calibration, costs):
            reason = f"an exact stage is not reproduced: {stage.note or 'no timing or gain error fits'}"
            return Unexplained(stage=stage.where.stage, actuator=stage.where.actuator, signature=reason)
    for finding, own in zip(findings, gaps, strict=True):
        left = {c: x for c, x in finding.left.items() if c in own}
        if left:
            return _described(finding, max(left, key=left.__getitem__), "")
    if not any(f.causes for f in findings) and not exact:
        finding, own = next((f, own) for f, own in zip(findings, gaps, strict=True) if own)
        return _described(finding, max(own, key=lambda c: own[c].power), "")
    changing = (_inconstant(f) for f in findings) if policy.constancy else ()
    return next((x for x in changing if x is not None), None)


def _reproduced(stage: ExactFinding, calibration: Calibration | None, costs: Costs) -> bool:
    """Whether the causes of an exact stage are its causes."""
    if calibration is None:
        return stage.closure.value >= REPRODUCED
    return answer_to_exact(reproduced(stage, calibration), costs) == LIBRARY


def _inconstant(finding: Finding) -> Unexplained | None:
    """A cause whose size differs between excitations stands in for an effect the library does not have."""
    for i in finding.attribution.causes:
        found = steadiness_of(finding.evidence, finding.attribution.fit, i)
        if not found.constant:
            term = finding.attribution.fit.terms[i]
            channel = max(sorted(term.channels), key=finding.evidence.excess)
            share = f"{found.spread:.1%} of what it explains differs"
            text = f"{term.effect.id} fits, but not with one size in all excitations ({share}); "
            return _described(finding, channel, text)
    return None


def _described(finding: Finding, channel: Channel, before: str) -> Unexplained:
    text = remainder(finding.evidence, channel, finding.attribution.fit)
    imitated = sorted(finding.imitations, key=lambda i: -i.closure.value)
    return Unexplained(stage=channel.stage, actuator=channel.actuator, signature=before + text, imitated_by=imitated)


def _crossing(library: Mapping[str, Effect], cause: Cause) -> bool:
    """Whether a rival is of another family; an effect that the cause contains was found to explain markedly less."""
    contained = library[cause.effect].extends if cause.effect in library else ()
    return any(library[r].family != cause.family for r in set(cause.rivals) - set(contained))
