"""One axis' signals of a run, filtered and sampled on the residual grid."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.filter import BANDWIDTH
from sher3_effects.motion import FilteredRun

from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.cut_off import cut_off
from sher3_chain.readings.level import at_a_level, off

NYQUIST_SHARE = 0.4
"""Cut-off over the Nyquist rate where a record is too slow for the engine's: two differentiations must survive it."""

SPLINE = 5
"""Order of the spline whose derivatives are taken: those of its neighbours are too small near the Nyquist frequency."""


@dataclass(frozen=True)
class AxisSignals(FilteredRun):
    """Signals of one axis, (n, 1) each in SI units; None where a signal was not recorded.

    The second index is the axis, so that the laws of the effects read one axis and a robot's five alike.

    Attributes:
        name: of the run; `excitation`: the name that repeats share.
        period: of the samples, s.
        motor: position of the axis' encoder.
        effort: measured force, or the force the command asks for.
        reference, command: as recorded.
        load: position of the second encoder.
        nominal: force that the user's own model asks for, less what is known to be applied from outside.
        applied: known force from outside, positive along the motion.
        temperature: of the axis, deg C.
        bandwidth: cut-off of the low-pass, Hz.
        limited: (n,) True where the measured force says nothing: flat at its largest reading, which the command does
            not ask, or exactly zero while the drive is off.
        UNSTATED: periods within which nobody states the moment of an effort; it is put right before anything is judged.
    """

    UNSTATED: ClassVar[float] = 1.0

    name: str
    excitation: str
    period: float
    motor: Array
    effort: Array | None = None
    reference: Array | None = None
    command: Array | None = None
    load: Array | None = None
    nominal: Array | None = None
    applied: Array | None = None
    temperature: Array | None = None
    bandwidth: float = BANDWIDTH
    limited: Mask | None = None

    @cached_property
    def stage_clock(self) -> Array:
        """Time since the first sample, (n,), s."""
        return self.period * np.arange(self.ticks, dtype=np.float64)

    @cached_property
    def effort_derivatives(self) -> tuple[Array, Array]:
        """First and second derivative of the effort, (n, 1) each, by a spline; of what was recorded, not smoothed."""
        from scipy.interpolate import make_interp_spline

        clock = self.stage_clock
        spline = make_interp_spline(clock, self.effort, k=min(SPLINE, len(clock) - 1))
        return spline(clock, 1), spline(clock, 2)

    @cached_property
    def loaded_ok(self) -> Mask:
        """(g,) True where the load on the axis is known: everywhere, since none acts."""
        return np.ones(len(self.grid), dtype=bool)


def signals_of(run: AxesRun, axis: Axis, excitation: str) -> AxisSignals:
    """Return the signals of one axis.

    Args:
        run: the record.
        axis: of the record.
        excitation: the name that repeats of the run share.
    """
    found = {k: x[:, None] for k, x in run.signals[axis.name].items()}
    most = min(BANDWIDTH, NYQUIST_SHARE * 0.5 / run.period)
    return AxisSignals(
        name=run.name,
        excitation=excitation,
        period=run.period,
        motor=found["position"],
        effort=_effort(found, axis),
        reference=found.get("reference"),
        command=found.get("command"),
        load=found.get("load"),
        nominal=_nominal(found),
        applied=found.get("applied"),
        temperature=found.get("temperature"),
        limited=None if axis.servo or axis.free else limited_by_reading(run.signals[axis.name]),
        bandwidth=most
        if axis.servo or axis.mass is None
        else cut_off(found["position"][:, 0], run.period, most, axis.free),
    )


def _effort(found: dict[str, Array], axis: Axis) -> Array | None:
    """The force on the axis (n, 1): measured, else what the command asks for; zero where nothing drives it."""
    law = axis.command_law
    if "effort" in found:
        return found["effort"]
    if "command" in found:
        return law.gain * (held_mean(found["command"]) if law.held else found["command"])
    return np.zeros_like(found["position"]) if axis.free else None


def _nominal(found: dict[str, Array]) -> Array | None:
    """The force (n, 1) that the user's model asks of the drive, which need not give what is applied from outside."""
    parts = [sign * found[name] for name, sign in (("nominal_effort", 1.0), ("applied", -1.0)) if name in found]
    return np.sum(parts, axis=0) if parts else None


def limited_by_reading(found: dict[str, Array]) -> Mask | None:
    """Return (n,) True where an effort is at a level; not where its command is, too: it is then what the drive gives.

    And where the drive is off. None where there is no effort, or none of it is at a level.
    """
    if "effort" not in found:
        return None
    at = at_a_level(found["effort"])
    if "command" in found:
        at &= ~at_a_level(found["command"])
    at |= off(found["effort"])
    return at if at.any() else None


def held_mean(command: Array) -> Array:
    """Return the mean around each sample of a command (n, 1) that is held from one sample to the next."""
    out = command.copy()
    out[1:] = 0.5 * (command[1:] + command[:-1])
    return out
