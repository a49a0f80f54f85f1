"""Residuals and floors of a serial arm in motion: what every joint is given beyond what its model says it needs."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Residual, Residuals
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.fit.term import again
from sher3_machines.errors import MachineError
from sher3_machines.thresholds import BLOCKS

from sher3_chain.chain.evidence import ChainEvidence, in_blocks
from sher3_chain.constants import ZERO, constants
from sher3_chain.floors.innovation import chain_floors, plain_innovation
from sher3_chain.joint.conditions import carried_in, conditions_of, reference_runs
from sher3_chain.joint.own_unit import RECORDED, renamed
from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import PER_RUN, Joint, ManipulatorDescription
from sher3_chain.manipulator.encoders import links_of
from sher3_chain.manipulator.identification.gains import backwards, share_of
from sher3_chain.manipulator.identification.inertias import Inertias, identified_inertias
from sher3_chain.manipulator.model import ArmModel
from sher3_chain.manipulator.readings.floors import resolution_floors
from sher3_chain.manipulator.readings.held import power_left, ways_to_act
from sher3_chain.manipulator.readings.mounted import mounted
from sher3_chain.manipulator.readings.senses import against_model
from sher3_chain.manipulator.readings.senses import turned as turned_round
from sher3_chain.manipulator.readings.slipped import slipped
from sher3_chain.manipulator.readings.wrong import without_wrong_loads
from sher3_chain.manipulator.signals import JointSignals, joint_signals
from sher3_chain.manipulator.view import MotionView
from sher3_chain.readings.slip_of_unit import Share

DROWNED = 0.1
"""Noise of a position over its motion, rms, above which nothing can be said of accelerations, nor of directions."""


@dataclass(frozen=True, kw_only=True)
class ArmMotionEvidence(ChainEvidence):
    """The evidence for an arm in motion.

    Attributes:
        described: the arm.
        judged: joints whose force balance is looked at.
        shares: joint -> units of its recorded effort per newton metre, where its gain was found from the data.
        turned: joints whose effort was recorded with the opposite sign, and was turned.
        scales: joint -> units of its recorded effort per newton metre in each record, where they differ by run.
        against: joints that were recorded in the other sense than the model has, and were turned.
        inertias: what was identified of links and rotors beyond the model; None: they are taken as modelled.
        gravity: (3,) in the frame of the base, m/s^2, where it pulls otherwise than the model says; None: as modelled.
        slips: joint -> times by which its effort is in another scale than its stated gain says; they are not judged.
        acting: how controls act between the rows of a log that is slower than its drives; empty: as read.
    """

    described: ManipulatorDescription
    records: Sequence[MotionView]
    judged: Sequence[str]
    shares: Mapping[str, Share] = field(default_factory=dict)
    turned: Sequence[str] = ()
    slips: Mapping[str, Share] = field(default_factory=dict)
    scales: Mapping[str, Sequence[Share]] = field(default_factory=dict)
    against: Sequence[str] = ()
    inertias: Inertias | None = None
    gravity: Array | None = None
    acting: str = ""

    def own_unit(self, unit: str, site: str) -> str:
        """Return the unit of a parameter, with forces as they were recorded where no gain is stated."""
        return renamed(unit, RECORDED) if site in self.shares else unit


def channel_of(joint: str) -> Channel:
    """Return the force balance of a joint."""
    return Channel("motor_mechanics", joint)


def between(joint: str) -> Channel:
    """Return the difference of the two encoders of a joint."""
    return Channel("transmission", joint)


def gather_arm_motion(
    runs: Sequence[AxesRun], described: ManipulatorDescription, model: ArmModel, judged: Sequence[str]
) -> ArmMotionEvidence:
    """Compute residuals and floors of every joint and cut them into blocks of time.

    Args:
        runs: records.
        described: the arm.
        model: of it.
        judged: joints whose effort was recorded; the others only move.

    Raises:
        MachineError: no joint can be judged.
    """
    repeats = described.repeats and len(runs) > 1
    n = len(described.joints)
    coupling = np.asarray(described.coupling if described.coupling is not None else np.eye(n), dtype=float)
    carried = carried_in(described.carried, [run.name for run in runs])
    read = [without_wrong_loads(run, described) for run in runs]
    signals = [joint_signals(run, described, "repeats" if repeats else run.name) for run in read]
    links = [links_of(s, described.joints, model, coupling) for s in signals]

    def seen_by(model: ArmModel, shares: Array, joints: Sequence[Joint] = described.joints) -> list[MotionView]:
        models = [model.carrying(x) for x in carried]
        each = zip(signals, links, models, strict=True)
        return [MotionView(s, link, joints, own, coupling, shares) for s, link, own in each]

    plain = seen_by(model, np.ones(n))
    gravity = mounted(plain, described, model, judged)
    if gravity is not None:
        model = replace(model, tree=replace(model.tree, gravity=gravity))
        plain = seen_by(model, np.ones(n))
    against = against_model(plain, described, model, judged)
    if against:
        read = [turned_round(run, against) for run in read]
        signals = [joint_signals(run, described, "repeats" if repeats else run.name) for run in read]
        links = [links_of(s, described.joints, model, coupling) for s in signals]
        plain = seen_by(model, np.ones(n))
    best, acting = (signals, links, plain), ""
    for note, acted in ways_to_act(plain, described, judged).items():
        signals, links = acted, [links_of(s, described.joints, model, coupling) for s in acted]
        other = seen_by(model, np.ones(n))
        if power_left(other, judged) < power_left(best[2], judged):
            best, acting = (acted, links, other), note
    signals, links, plain = best
    found = {name: share_of(plain, name) for name in judged}
    stated = {j.name for j in described.joints if not isinstance(j.gain, str)}
    own = [j.name for j in described.joints if j.gain == PER_RUN and j.name in judged]
    scales = {name: [share_of([view], name) for view in plain] for name in own}
    judged = [name for name in judged if all(share.identified for share in scales.get(name, ()))]
    slips = slipped(plain, {name: found[name] for name in judged if name in stated})
    judged = [name for name in judged if name not in slips]
    turned = backwards({name: found[name] for name in judged if name not in own}, stated)
    if turned or own:
        signals = _correct_readings(signals, described, turned, scales)
        plain = seen_by(model, np.ones(n))
    inertias = None
    if described.inertias == "identified":
        names = [run.name for run in runs]
        reference = reference_runs(conditions_of(described.conditions, names), names)
        kept = [view for view, name in zip(plain, names, strict=True) if name in reference]
        inertias = identified_inertias(kept, model, judged)
    unknown = [j.name for j in described.joints if j.gain == "unknown" and j.name in judged]
    shares = {name: found[name].turned() for name in unknown}
    modelled = shares if inertias is None else {}  # those found from the data are in the unit of the effort
    factors = np.array([modelled[j.name].value if j.name in modelled else 1.0 for j in described.joints])
    if inertias is not None:
        views = seen_by(inertias.model(model), factors, inertias.at(described.joints))
    else:
        views = seen_by(model, factors) if shares else plain
    residuals = [residuals_of(view, judged) for view in views]
    if not any(residuals):
        raise not_judged(judged, signals, slips)
    floors = chain_floors(views, residuals, repeats, resolution_floors, plain_innovation)
    seen = tuple(j for j in judged if any(channel_of(j) in x for x in residuals))
    data = in_blocks(views, residuals, floors)
    return ArmMotionEvidence(
        excitations=[view.excitation for view in data.views],
        data=data,
        nuisance=constants(data, ZERO, [between(j) for j in judged]),
        units={
            **{
                channel_of(j.name): RECORDED if j.gain == "unknown" else "N" if j.motion == "linear" else "N*m"
                for j in described.joints
            },
            **{between(j.name): j.unit_of_position for j in described.joints},
        },
        places={"axis": seen, "link": model.links},
        rotary=frozenset(j.name for j in described.joints if j.motion == "rotary"),
        described=described,
        runs=list(runs),
        records=views,
        judged=seen,
        shares=shares,
        turned=turned,
        slips=slips,
        scales=scales,
        against=against,
        inertias=inertias,
        gravity=gravity,
        acting=acting,
    )


def not_judged(judged: Sequence[str], signals: Sequence[JointSignals], slips: Mapping[str, Share]) -> MachineError:
    """Return the error of an arm without a joint that can be judged: no force is known, or too little motion."""
    if slips and not judged:
        each = ", ".join(f"{joint} {share.value:.4g}" for joint, share in slips.items())
        remedy = "give efforts in N m: state `factor` of a column or `gain`, or let the model tell it: `gain: unknown`"
        what = "no joint can be judged: efforts are this many times what the model needs"
        return MachineError(what, value=each, limit="1", remedy=remedy)
    if not judged:
        gains = "`command_law: {kind: force, position_gain: ..., velocity_gain: ...}`"
        remedy = f"record efforts, or references: state the {gains} of servos, or leave the model out of their draft"
        return MachineError(
            "no joint can be judged: none has a force that is known and a position that moves",
            value="0 joints",
            remedy=remedy,
        )
    ticks = max(s.ticks for s in signals)
    noise, course = (
        max(float(x(s).std()) for s in signals) for x in (lambda s: s.motor - s.smooth, lambda s: s.smooth)
    )
    if noise > DROWNED * course:
        remedy = "record quieter positions: forces follow from how they bend, which this noise hides"
        value, limit = f"{noise:.2g} about a motion of {course:.2g}", f"{DROWNED:g} of it"
        what = "no joint can be judged: positions scatter about their own course, rms in rad or m"
        return MachineError(what, value=value, limit=limit, remedy=remedy)
    remedy = "record efforts while the joints move, for some seconds"
    value = f"{len(judged)} joints, {ticks} samples"
    return MachineError("no joint can be judged: too little of the record is motion", value=value, remedy=remedy)


def _correct_readings(
    signals: Sequence[JointSignals],
    described: ManipulatorDescription,
    turned: Collection[str],
    scales: Mapping[str, Sequence[Share]],
) -> list[JointSignals]:
    """Return the signals with efforts of the opposite sign turned, and those of another unit in each run in N m."""
    out = []
    for r, s in enumerate(signals):
        by = [-1.0 if j.name in turned else 1.0 for j in described.joints]
        for i, joint in enumerate(described.joints):
            share = scales[joint.name][r] if joint.name in scales else None
            by[i] = share.value if share is not None and share.identified else by[i]
        assert s.effort is not None
        out.append(replace(s, effort=s.effort / np.array(by)))
    return out


def select_channel(
    evidence: ArmMotionEvidence, channel: Channel, beside: Sequence[Mapping[Channel, Array]] = ()
) -> Evidence:
    """Return the evidence of one channel alone.

    Args:
        evidence: of the arm.
        channel: of a joint to be looked at.
        beside: per block, what causes of the whole arm add to the residuals, (g, 1) in SI units; taken off.
    """
    data = evidence.data
    residuals: list[Residuals] = []
    for r, found in enumerate(data.residuals):
        own = {channel: found[channel]} if channel in found else {}
        known = beside[r].get(channel) if beside else None
        if own and known is not None:
            own[channel] = replace(own[channel], values=own[channel].values - known)
        residuals.append(own)
    floors = [{channel: f[channel]} if channel in f else {} for f in data.floors]
    alone = Standardised(data.views, residuals, floors)
    return Evidence(
        excitations=evidence.excitations,
        data=alone,
        nuisance=again(alone, [t for t in evidence.nuisance if channel in t.channels]),
        units=evidence.units,
        places={"axis": (channel.actuator,)},
        rotary=evidence.rotary,
    )


def residuals_of(view: MotionView, judged: Sequence[str]) -> Residuals:
    """Return the force balance of each judged joint, and the difference of its two encoders."""
    run, out = view.run, Residuals()
    left = view.effort - view.inertial
    for joint in judged:
        row, apart = view.row(joint), run.inner & ~view.impacts
        out[channel_of(joint)] = Residual(left[:, [row]], view.in_motion(row))
        if run.load is not None and np.isfinite(run.load[:, row]).all():
            out[between(joint)] = Residual(run.to_grid(run.load[:, [row]] - run.motor[:, [row]]), apart)
    return {channel: x for channel, x in out.items() if x.ok.sum() >= BLOCKS}
