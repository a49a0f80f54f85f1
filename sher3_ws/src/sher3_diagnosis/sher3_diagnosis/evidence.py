"""The evidence of a diagnosis: residuals over their floors, and what the engine must know of the machine to read them.

A machine makes one piece of evidence for each part that is judged by itself: SHER is one part, of a chain of axes
every axis is one.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, Protocol

from sher3_diagnosis.channel import Array, Channel, Floors, Mask
from sher3_diagnosis.effect import ROTARY
from sher3_diagnosis.fit.fitting import Fit, Term, fit
from sher3_diagnosis.fit.standardised import Standardised

TURNS = 3
"""First component of a pose or a wrench that is a rotation or a torque."""


class Motion(NamedTuple):
    """How one axis moves in a run, on the residual grid of g samples.

    Attributes:
        position: (g,) m or rad.
        velocity: (g,) m/s or rad/s.
        top: largest velocity of the axis, m/s or rad/s.
        lead: travel per motor revolution, m or rad; None when it is not known.
    """

    position: Array
    velocity: Array
    top: float
    lead: float | None


class View(Protocol):
    """What the engine reads of a run to say in which regime a gap lives; machines add what their effects need."""

    excitation: str
    """Name of what the run was driven with."""
    rate: float | None
    """Samples per second of the residual grid, Hz; None where the samples are no course in time."""
    loaded: Mask
    """(g,) True where a load acts."""
    warmth: Array
    """(g,) temperature above the reference, K; zero where it was not recorded."""
    temperature_known: bool
    """Whether the temperature was recorded."""
    speed_share: Array
    """(g,) speed of the whole machine over its largest."""

    def motion(self, actuator: str) -> Motion | None:
        """Return the motion of an axis; None for a place that is no axis."""

    def inputs(self, actuator: str) -> Array:
        """Return (g, k) quantities a static law at this place could depend on."""


@dataclass(frozen=True)
class Evidence:
    """Everything the engine works on.

    Attributes:
        excitations: per run, the name of its excitation; runs of one name are repeats.
        data: residuals and floors, standardised.
        units: channel -> SI unit of its first components; the last three of six turn: rad for m, N*m for N.
        places: kind of place -> the sites that are one; effects say on which they may sit.
        rotary: sites that turn.
        counts: actuator -> one count of its encoder, m or rad.
        nuisance: terms that every fit carries, so that no effect is blamed for what they explain.
    """

    excitations: Sequence[str]
    data: Standardised
    units: Mapping[Channel, str]
    places: Mapping[str, Sequence[str]]
    rotary: frozenset[str] = frozenset()
    counts: Mapping[str, float] = field(default_factory=dict)
    nuisance: tuple[Term, ...] = ()

    @property
    def views(self) -> list[View]:
        """What effects see, per run."""
        return self.data.views

    @property
    def floors(self) -> list[Floors]:
        """Floor per run and channel."""
        return self.data.floors

    @property
    def channels(self) -> list[Channel]:
        """Every channel that some run has, in order."""
        return sorted({c for r in self.data.residuals for c in r})

    @property
    def repeats(self) -> int:
        """Degrees of freedom of the repeat floor: runs beyond the first of each excitation."""
        return len(self.excitations) - len(set(self.excitations))

    def null(self) -> Fit:
        """Return the fit without any cause, computed once."""
        return self._null

    @cached_property
    def _null(self) -> Fit:
        return fit(self.data, self.nuisance)

    def count(self, channel: Channel) -> float:
        """Return one encoder count at a channel; infinite where nobody says where two encoders have their zeros."""
        return self.counts.get(channel.actuator, math.inf)

    def unit(self, channel: Channel, component: int = 0) -> str:
        """Return the unit of a component of a channel: the last three of six are a rotation or a torque."""
        unit = self.units[channel]
        return unit if component < TURNS else ROTARY[unit]

    def own_unit(self, unit: str, site: str) -> str:
        """Return the unit of a parameter at a site where forces were not recorded as such; default the SI unit."""
        return unit

    def component(self, channel: Channel, component: int) -> str | None:
        """Return the name of a component: `x` to `rz` of a pose, `fx` to `tz` of a wrench; None for a single one."""
        residual = next(r[channel] for r in self.data.residuals if channel in r)
        if residual.values.shape[1] == 1:
            return None
        kinds = ("f", "t") if self.units[channel] == "N" else ("", "r")
        return kinds[component // TURNS] + "xyz"[component % TURNS]

    def samples(self, channel: Channel) -> int:
        """Return the standardised samples of a channel over all runs: its loss at the floor."""
        return sum(n for (_, c), n in self.data.samples.items() if c == channel)

    def excess(self, channel: Channel, after: Fit | None = None) -> float:
        """Return the loss above the floor of a channel under a fit; without one, under the fit without any cause."""
        return self.loss(channel, self.null() if after is None else after) - self.samples(channel)

    def loss(self, channel: Channel, after: Fit) -> float:
        """Return the held-out loss of a channel under a fit."""
        return sum(v for (_, c), v in after.loss.items() if c == channel)
