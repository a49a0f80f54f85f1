"""Residuals and floors of one axis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Mask, Residual, Residuals
from sher3_machines.errors import MachineError
from sher3_machines.thresholds import BLOCKS

from sher3_chain.axes.floors import floors_of
from sher3_chain.axes.identification.acting import acting
from sher3_chain.axes.identification.align import aligned
from sher3_chain.axes.identification.identify import identify_mass, load_mass_of, share_of_inertia
from sher3_chain.axes.scale import slip_of
from sher3_chain.axes.stops import with_stops
from sher3_chain.axes.view import AxisView
from sher3_chain.chain.evidence import ChainEvidence, in_blocks
from sher3_chain.constants import ZERO, constants
from sher3_chain.joint.conditions import carried_in
from sher3_chain.joint.description import Axis
from sher3_chain.joint.own_unit import renamed
from sher3_chain.joint.record import AxesRun
from sher3_chain.power import BALANCE, hidden_share
from sher3_chain.readings.level import at_a_level, level_note, off, off_note
from sher3_chain.readings.signals import AxisSignals, signals_of
from sher3_chain.thresholds import NO_INERTIA


@dataclass(frozen=True, kw_only=True)
class AxisEvidence(ChainEvidence):
    """The evidence for one axis.

    Nothing says where two encoders have their zeros, so that `counts` is empty and their difference is free.

    Attributes:
        axis: as described.
        mass: nominal or identified, kg or kg m^2, without what runs carried; 0 where the force balance is not looked
            at.
        mass_interval: 95 %, of an identified mass.
        not_judged: why the force balance is not judged, where a mass could not be identified.
        notes: what was put right of the effort.
    """

    axis: Axis
    records: Sequence[AxisView]
    mass: float
    mass_interval: tuple[float, float] | None = None
    not_judged: str = ""
    notes: Sequence[str] = ()

    def own_unit(self, unit: str, site: str) -> str:
        """Return the unit of a parameter, with forces as they were recorded."""
        return renamed(unit, self.axis.own_unit) if self.axis.own_unit else unit


def gather_axis(runs: Sequence[AxesRun], axis: Axis, repeats: bool, held: str = "") -> AxisEvidence:
    """Compute residuals and floors of one axis and cut them into blocks; `held`: why its force says nothing.

    An axis of which nothing else can be judged, because its effort is dead, tells no force balance, or one whose floor
    is larger than its forces, is judged by how it follows its reference, where one was recorded.
    """
    found = _gathered(runs, axis, repeats, held)
    tracked = axis.tracked if all("reference" in run.signals[axis.name] for run in runs) else None
    signal = partial(signal_of, found)
    if tracked is None or any(c.stage != BALANCE or hidden_share(found, c, signal) < 1.0 for c in found.channels):
        return found
    judged = _gathered(runs, tracked, repeats)
    note = f"{axis.name}: its effort tells no force balance; judged by how it follows its reference"
    return replace(judged, not_judged=found.not_judged, notes=[*found.notes, *judged.notes, note])


def signal_of(evidence: AxisEvidence, r: int, site: str, ok: Mask) -> Array:
    """Return the force of an axis, recorded or needed, or what a servo was asked beside its mean, (n,)."""
    view = evidence.data.views[r]
    run = view.run
    if evidence.axis.servo:
        asked = run.to_grid(run.reference)[ok, 0]
        return np.asarray(asked - asked.mean())
    given, needed = run.to_grid(run.effort)[ok, 0], view.inertial[ok, 0]
    return np.maximum(np.abs(given), np.abs(needed))


def _gathered(runs: Sequence[AxesRun], axis: Axis, repeats: bool, held: str = "") -> AxisEvidence:
    """Compute residuals and floors of one axis as it is described."""
    signals: Sequence[AxisSignals] = [signals_of(run, axis, "repeats" if repeats else run.name) for run in runs]
    slip = slip_of(signals, axis) or ""
    if slip:
        runs = [run.without(axis.name, ("effort",)) for run in runs]
        signals = [replace(s, effort=None) for s in signals]
    signals, notes = aligned(signals, axis)
    axis, stops = with_stops(signals, axis)
    notes = [*levels_of(signals, axis), *notes, *stops]
    mass, interval = (axis.mass, None) if isinstance(axis.mass, float) else (0.0, None)
    not_judged, load_mass = held or slip, 0.0
    if not held and axis.mass == "unknown" and all(s.effort is not None for s in signals):
        try:
            acts = acting(signals, axis)
            load_mass = load_mass_of([AxisView(s, axis, 0.0) for s in acts])
            mass, interval = identify_mass([AxisView(s, axis, 0.0, load_mass) for s in acts])
        except MachineError as error:
            share = share_of_inertia([AxisView(s, axis, 0.0) for s in signals])
            if share < NO_INERTIA:
                most = f"{100.0 * share:.2g} % of the force"
                text = f"the record does not tell its mass, which needs at most {most}; left out"
                notes = [*notes, f"{axis.name}: {text}"]
            else:
                not_judged = str(error)
    carried = carried_in(axis.carried, [s.name for s in signals])
    records = [AxisView(s, axis, mass + (m or 0.0), load_mass) for s, m in zip(signals, carried, strict=True)]
    found = [residuals_of(view) for view in records]
    if not_judged:
        found = [{c: x for c, x in residuals.items() if c.stage != BALANCE} for residuals in found]
    floors = floors_of(records, found, repeats)
    data = in_blocks(records, found, floors)
    return AxisEvidence(
        excitations=[view.excitation for view in data.views],
        data=data,
        nuisance=constants(data, ZERO, with_zeros(axis)),
        units=units_of(axis),
        places={"axis": (axis.name,)},
        rotary=frozenset({axis.name} if axis.motion == "rotary" else ()),
        axis=axis,
        runs=list(runs),
        records=records,
        mass=mass,
        mass_interval=interval,
        not_judged=not_judged,
        notes=notes,
    )


def with_zeros(axis: Axis) -> list[Channel]:
    """Return the channels of unknown zero: of two encoders, and of a servo of which a speed was recorded or asked.

    A speed adds up to a place from any zero on.
    """
    stages = ("transmission", "motor_mechanics") if axis.servo and axis.summed else ("transmission",)
    return [Channel(stage, axis.name) for stage in stages]


def levels_of(signals: Sequence[AxisSignals], axis: Axis) -> list[str]:
    """Return a sentence for each record whose effort lies flat at its largest reading, or whose drive is off."""
    notes = []
    for s in signals:
        if s.limited is not None and s.effort is not None:
            effort = s.effort[:, 0]
            silent = off(effort)
            flat = s.limited & at_a_level(effort) & ~silent
            notes += [level_note(f"{s.name}: {axis.name}.effort", flat)] if flat.any() else []
            notes += [off_note(f"{s.name}: {axis.name}.effort", silent)] if silent.any() else []
    return notes


def units_of(axis: Axis) -> Mapping[Channel, str]:
    """Return the unit of each channel; the tracking error of a servo is a position."""
    force = axis.unit_of_position if axis.servo else axis.unit_of_force
    return {
        Channel("motor_mechanics", axis.name): force,
        Channel("transmission", axis.name): axis.unit_of_position,
    }


def residuals_of(view: AxisView) -> Residuals:
    """Return the residuals of one record.

    They are the force balance, or the tracking error of a servo, and load encoder minus motor encoder. Balance and
    error are judged in motion: at rest friction holds any of them. A servo that mostly rests is judged throughout.
    """
    run, axis = view.run, view.described
    out: Residuals = {}
    if axis.servo:
        assert run.reference is not None
        judged = view.in_motion if view.mostly_moves else run.inner
        out[Channel("motor_mechanics", axis.name)] = Residual(run.to_grid(run.reference - run.motor), judged)
    elif (axis.mass is not None or axis.signals.nominal_effort is not None) and run.effort is not None:
        balance = run.to_grid(run.effort) - view.inertial
        out[Channel("motor_mechanics", axis.name)] = Residual(balance, view.in_motion)
    if run.load is not None:
        out[Channel("transmission", axis.name)] = Residual(run.to_grid(run.load - run.motor), run.inner)
    return {channel: x for channel, x in out.items() if x.ok.sum() >= BLOCKS}
