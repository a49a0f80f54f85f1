"""Evidence for an exact stage, for discovery alone: how an unknown law could change a command.

The stage's error is computed to rounding, so that it has no floor of its own: a hundredth of the error counts as
nothing, and no formula is asked to do better. What was passed on is looked at a few ticks earlier, too: the usual laws
here are of time.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from sher3_common.laws import EARLIER
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array, Channel, Mask, Residual
from sher3_diagnosis.discover.feature import Quantities, Quantity
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.standardised import Standardised

from sher3_gap.signals import RunSignals
from sher3_gap.stages.exact.law import controller_error, delayed, host_law, transport_error
from sher3_gap.stages.recorded import motion_of, shared_by_all, speed_unit

CONTROLLER, TRANSPORT = "controller", "transport"
FLOOR = 0.01
"""Share of an axis' error that counts as nothing."""
MOST_TICKS = 4000
"""Ticks of a run that are looked at, evenly spread: more cost time and tell the same."""


class ExactView:
    """A run of the robot at an exact stage, tick by tick.

    Attributes:
        run: its signals.
        robot: the nominal model.
        stage: controller or transport.
    """

    def __init__(self, run: RunSignals, robot: Robot, stage: str) -> None:
        self.run, self.robot, self.stage = run, robot, stage

    @cached_property
    def error(self) -> Array | None:
        """Error of the stage, (n, axes); None where it was not recorded."""
        return controller_error(self.run, self.robot) if self.stage == CONTROLLER else transport_error(self.run)

    @cached_property
    def ticks(self) -> NDArray[np.int64]:
        """Ticks that are looked at, (g,)."""
        return np.arange(0, self.run.ticks, -(-self.run.ticks // MOST_TICKS))

    @property
    def tells(self) -> Mask:
        """(g,) True at ticks whose error counts."""
        tells = self.run.command_counts if self.stage == CONTROLLER else self.run.echo_tells
        return tells[self.ticks]

    @property
    def step(self) -> float:
        """Time between two ticks, s."""
        return self.run.period

    def at_residuals(self, x: Array) -> Array:
        """Take (n, ...) values of the record to the ticks that are looked at, (g, ...)."""
        return x[self.ticks]

    def recorded(self, channel: Channel) -> Quantities:
        """Return what the law of an error at an actuator might depend on."""
        i, unit = ACTUATORS.index(channel.actuator), speed_unit(channel.actuator)
        out = motion_of(self.run, channel.actuator, "", True)
        if self.stage == TRANSPORT:
            assert self.run.command is not None
            given = delayed(self.run.command, 1)[:, i]
            out["command"] = Quantity(given, unit, "the command", "command")
            out |= self._changes("command", given, unit, "the command")
        else:
            assert self.run.load is not None and self.run.reference is not None
            law = host_law(self.run, self.robot, self.robot.position_gain)[:, i]
            reading = self.run.load[:, i]
            out["wanted"] = Quantity(law, unit, "the command that the law asks for", "command")
            error = self.run.reference[:, i] - reading
            out["error"] = Quantity(error, unit.removesuffix("/s"), "the error of position", "place")
            out |= self._changes("wanted", law, unit, "the command that the law asks for")
            out |= self._changes("reading", reading, unit.removesuffix("/s"), "the reading")
        return out | shared_by_all(self.run)

    def _changes(self, name: str, x: Array, unit: str, words: str) -> dict[str, Quantity]:
        """Return how much a signal (n,) changed within some last ticks."""
        found = {}
        for n in EARLIER:
            change = x - np.concatenate([x[:1].repeat(n), x[:-n]])
            said = f"the change of {words} within {1e3 * n * self.run.period:.3g} ms"
            found[f"{name}.change_{n}"] = Quantity(change, unit, said, "change", False)
        return found


def exact_evidence(runs: Sequence[RunSignals], robot: Robot, stage: str) -> Evidence:
    """Return the errors of a stage on every axis that has any.

    Args:
        runs: of the case; those that do not tell the stage are left out.
        robot: the nominal model.
        stage: controller or transport.
    """
    views = [v for v in (ExactView(run, robot, stage) for run in runs) if v.error is not None]
    power = sum(np.sum(error[view.tells] ** 2, axis=0) for view, error in _errors(views))
    size = np.sqrt(power / sum(int(view.tells.sum()) for view in views))
    channels = {Channel(stage, name): i for i, name in enumerate(ACTUATORS) if size[i] > 0.0}
    residuals = [
        {c: Residual(error[:, [i]], view.tells) for c, i in channels.items()} for view, error in _errors(views)
    ]
    floors = [{c: FLOOR * size[[i]] for c, i in channels.items()} for _ in views]
    units = {c: speed_unit(c.actuator) for c in channels}
    return Evidence([v.run.excitation for v in views], Standardised(views, residuals, floors), units, {})


def _errors(views: Sequence[ExactView]) -> Iterator[tuple[ExactView, Array]]:
    """Yield views with their errors at the ticks that are looked at, (g, axes)."""
    for view in views:
        assert view.error is not None
        yield view, view.error[view.ticks]
