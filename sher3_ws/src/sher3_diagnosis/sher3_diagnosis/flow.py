"""The one flow of every diagnosis: audit, localise, attribute, quantify, judge."""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cache, partial
from importlib.metadata import version
from typing import TypeVar

from sher3_common import Sher3Error
from sher3_common.progress import Say, silent

from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.polish import polished
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.finding import Finding
from sher3_diagnosis.judge.borne_out import significant_causes
from sher3_diagnosis.judge.calibrated_causes import weighed
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.causes import causes_of
from sher3_diagnosis.judge.costs import DEFAULT, Costs
from sher3_diagnosis.judge.judge import judge
from sher3_diagnosis.judge.left_over import down_to_floor, left_over
from sher3_diagnosis.judge.meaning import without_empty, without_open_sizes
from sher3_diagnosis.localise.gaps import localise
from sher3_diagnosis.machine import Diagnosis, Machine
from sher3_diagnosis.quantify.closure import residual_after
from sher3_diagnosis.quantify.least_seen import would_have_shown
from sher3_diagnosis.quantify.motion import in_motion

R = TypeVar("R")
E = TypeVar("E", bound=Evidence)
version_of = cache(version)
"""Version of an installed package, read once in a process: its file of metadata takes 1 ms."""


class UnknownEffect(Sher3Error):
    """An effect id that the library does not have."""


def diagnose(
    machine: Machine[R, E],
    runs: Sequence[R],
    without: Collection[str] = (),
    say: Say = silent,
    started: float | None = None,
    costs: Costs = DEFAULT,
) -> Diagnosis[E]:
    """Say where a machine leaves its model, which effects explain it, and how far the gap shrinks.

    Args:
        machine: gives residuals, floors, effects, exact stages and a simulator.
        runs: of one machine in one condition, repeats included.
        without: effect ids that are left out of the library.
        say: takes a line of progress.
        started: value of `time.perf_counter` at which the work began, s; default now.
        costs: of wrong answers.

    Raises:
        UnknownEffect: an id in `without` is none of the machine's effects.
    """
    started = time.perf_counter() if started is None else started
    check_known(machine, without)
    notes = machine.audit(runs)
    say("computing residuals and floors")
    parts = machine.gather(runs)
    exact = machine.exact(runs, parts, without)
    findings = [find(machine, part, without, say) for part in parts]
    notes += [n for f in findings for n in f.notes]
    say("judging")
    findings = weighed(findings, in_force(), machine.policy.own_level, costs)
    verdict = judge(machine, findings, exact, notes, costs)
    said = {"noise": list(machine.noise(runs)), "versions": {p: version_of(p) for p in machine.sources}}
    verdict = verdict.model_copy(update={**said, "seconds": time.perf_counter() - started})
    return Diagnosis(verdict, findings, exact, machine)


def find(machine: Machine[R, E], evidence: E, without: Collection[str], say: Say) -> Finding[E]:
    """Localise the gaps of one part of a machine, attribute them and quantify the causes."""
    machine = machine.of(evidence)
    gaps = localise(evidence, nominal(evidence))
    significant = [g.channel for g in gaps if g.significant]
    candidates = Candidates(evidence, [e for e in machine.effects(evidence) if e.id not in without])
    rule = down_to_floor if machine.plan(evidence).down_to_floor else left_over
    attribution = machine.attribute(evidence, candidates, partial(rule, significant, evidence), say)
    say("quantifying")
    attribution = polished(evidence, attribution)
    attribution = replace(attribution, moving=in_motion(evidence, attribution.fit))
    refined, causes = machine.refine(evidence, causes_of(evidence, attribution), attribution)
    remains = partial(left_over, significant, evidence)
    while machine.policy.swept:
        fewer = without_empty(candidates, attribution, causes, remains, machine.policy.carried)
        fewer = significant_causes(evidence, attribution, remains) if fewer is attribution else fewer
        if fewer is attribution:
            break
        attribution = fewer
        refined, causes = machine.refine(evidence, causes_of(evidence, attribution), attribution)
    causes = without_open_sizes(attribution, causes)
    finding = Finding(refined, gaps, attribution, causes, remains(attribution.fit))
    power = would_have_shown(evidence, candidates.effects, significant) if machine.policy.absences else []
    return replace(finding, notes=[*machine.remarks(finding), *power])


def nominal(evidence: Evidence) -> dict[Channel, dict[int, Array]]:
    """Return the residual (n, d) of every channel and run beyond the terms that are no causes; empty without any."""
    if not evidence.nuisance:
        return {}
    null = evidence.null()
    return {channel: residual_after(evidence, null, channel) for channel in evidence.channels}


def check_known(machine: Machine, ids: Collection[str]) -> None:
    """Refuse ids that are none of the machine's effects; raises UnknownEffect."""
    known = sorted({e.id for e in machine.library()})
    unknown = sorted(set(ids) - set(known))
    if unknown:
        raise UnknownEffect.unknown("no such effect", ", ".join(unknown), known)
