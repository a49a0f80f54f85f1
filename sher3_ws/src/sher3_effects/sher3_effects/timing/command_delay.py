"""Command delay: every command acts a constant time after it was given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature
from sher3_sim.effect import EVERYWHERE, PlantEffect, parameter

from sher3_effects.delay import tried
from sher3_effects.page import NOWHERE, Page
from sher3_effects.view import AxisView, LawView


class CommandDelay(Page):
    """Read off the echo tick by tick: the stage is exact and needs no fit."""

    id, family, stage = "command_delay", "timing", "transport"
    inputs = ("command",)
    seen_at, computed = NOWHERE, "delay"
    best = Best("steps", "steps of several amplitudes show a dead time as an onset and a lag as a slope")
    explanation = "A constant dead time between the host's command and the drives' demand, the same on every axis."
    siblings = {"drive_lag": "the echo is on time, the force is late"}


class ServoDelay(CommandDelay):
    """A position servo that follows its reference a dead time late."""

    kinds = ("servo",)
    seen_at = (("motor_mechanics", ""),)
    gives = ("delay",)
    on_axis = {"delay": "delay"}
    explanation = "The axis follows its reference a fixed time late."
    siblings = {"drive_lag": "the reference is smoothed as well as late"}
    PERIODS = (0.25, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)
    """Dead times that are tried, in periods of the record; longer ones follow, see `tried`."""
    finer = {"delay": (0.8, 0.9, 0.95, 1.05, 1.1, 1.25)}

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return dead times, s."""
        return [{"delay": t} for t in tried(self.PERIODS, views[0].run.period)]

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return reference minus the reference of a dead time ago; nothing is left to fit."""
        assert view.run.reference is not None
        clock, reference = view.run.stage_clock, view.run.reference[:, view.row(site)]
        late = np.interp(clock - shape["delay"], clock, reference)
        return Signature({}, {self.channels(site)[0]: view.run.to_grid((reference - late)[:, None])})


class DelayOfLaw(CommandDelay):
    """The recorded command follows the stated law late, or follows its reference late."""

    kinds = ("law",)
    seen_at = (("controller", ""),)
    explanation = "The recorded command is the stated law's, or that for the reference, a fixed time late."
    siblings = {"controller_gain": "right in time, and too large or too small"}
    units = {"delay": "s", "reference_delay": "s"}
    on_axis = {"reference_delay": "servo_delay"}
    discrete = frozenset({"of_reference"})
    PERIODS = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0)
    """Delays that are tried, in periods of the record: nobody states the moment of a command within one."""
    finer = {"delay": (0.85, 0.92, 0.97, 1.03, 1.08, 1.2)}

    def stage_at(self, channel: Channel) -> str:
        """Return the controller."""
        return channel.stage

    def shapes(self, views: Sequence[LawView], site: str) -> list[Shape]:
        """Return delays, s, of all of the law or of its reference alone."""
        return [{"delay": n * views[0].run.period, "of_reference": k} for n in self.PERIODS for k in (0.0, 1.0)]

    def signature(self, view: LawView, site: str, shape: Shape) -> Signature:
        """Return the delayed law less the law, or the change of the law by a delayed reference."""
        clock, law = view.run.stage_clock, view.stated
        if shape["of_reference"]:
            asked = view.run.reference[:, 0]
            error = np.interp(clock - shape["delay"], clock, asked) - asked
            late = law.clipped(law.parts.sum(axis=1) + law.gain * error)
        else:
            late = np.interp(clock - shape["delay"], clock, law.command)
        return Signature({}, {self.channels(site)[0]: view.run.to_grid((late - law.command)[:, None])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the delay [s] of the shape; there are no coefficients, (0,)."""
        return {"reference_delay" if shape["of_reference"] else "delay": shape["delay"]}


class DelayOfServo(CommandDelay):
    """The servo of a joint acts on a reference of another moment, where its law stands for the effort.

    The effort is K (r - q) - D v at one moment; a servo that acts late, or a position that is read late, leaves
    K (r(t) - r(t - delay)) of it. Below zero the reference was logged late.
    """

    kinds = ("joint",)
    seen_at = (("motor_mechanics", ""),)
    gives = ("reference_delay",)
    explanation = "The servo follows its reference a fixed time late; or its position is read late, which looks alike."
    siblings = {"viscous_friction": "needs force; where the reference is followed closely, it goes by the speed, too"}
    units = {"reference_delay": "s"}
    on_axis = {"reference_delay": "servo_delay"}
    PERIODS = ServoDelay.PERIODS
    finer = ServoDelay.finer

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return delays, s, either way; none where an effort was recorded."""
        found = [sign * n * views[0].run.period for n in self.PERIODS for sign in (1.0, -1.0)]
        return [{"delay": delay} for delay in found] if views[0].axis(site).follows else []

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return the force by which the law of now differs from that of a delay ago; nothing is left to fit."""
        assert view.run.reference is not None
        clock, reference = view.run.stage_clock, view.run.reference[:, view.row(site)]
        late = np.interp(clock - shape["delay"], clock, reference)
        own = view.axis(site).follows * (reference - late)
        return Signature({}, {self.channels(site)[0]: view.run.to_grid(own[:, None])})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the delay of the reference [s], of the shape; there are no coefficients, (0,)."""
        return {"reference_delay": shape["delay"]}


@dataclass(frozen=True)
class CommandDelayInPlant(PlantEffect, page=CommandDelay, sites=EVERYWHERE):
    """Every command acts a constant time after it was published: bus cycle, buffers, computing time."""

    delay: float = parameter("s", 1e-3, 0.0, 0.03, "dead time of the command", on="delay")
