"""What an effect is: one page that says what it is, where it may sit, how it shows, and how its numbers read.

A signature is linear in its coefficients. Where the law needs more, it is nonlinear in a `shape` that is searched over
a few values. Every fit is then a small least-squares problem whose held-out loss is exact.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.thresholds import RIVAL

Shape = Mapping[str, float]
"""Values of the parameters in which a law is not linear."""

ROTARY = {
    "m": "rad",
    "N": "N*m",
    "N/(m/s)": "N*m/(rad/s)",
    "m/s": "rad/s",
    "N/m": "N*m/rad",
    "m/N": "rad/(N*m)",
    "kg": "kg*m^2",
}
"""Unit on a linear axis -> unit of the same quantity on an axis that turns."""


INPUTS: Mapping[str, str] = {
    "position": "position of the motor",
    "velocity": "velocity of the motor",
    "direction": "direction of motion and the travel since it last changed",
    "acceleration": "acceleration of the motor, or of the tip",
    "force": "force that the drive gives or the axis carries",
    "weight": "weight that the axis carries",
    "load": "load on the tip",
    "loading": "force that it went through before",
    "posture": "posture of the whole machine",
    "temperature": "temperature of the machine",
    "time": "time since the run or the session began",
    "command": "what the host or the drive was asked for",
}
"""Quantities that the law of an effect may depend on."""


KINDS: Mapping[str, str] = {
    "robot": "the robot",
    "axis": "an axis",
    "servo": "a position servo",
    "joint": "a joint of a serial arm in motion",
    "arm": "the geometry of a serial arm",
    "table": "an axis in a positioning test",
    "circle": "two axes on a circle",
    "sensor": "a force sensor by itself",
    "cell": "a force sensor of one axis",
    "law": "the command of an axis against its stated law",
}
"""Kinds of machine that an effect may be written for -> plain words; a joint has the pages of an axis too."""


class Measured(NamedTuple):
    """A parameter that is told by other means than the fit, SI units.

    Attributes:
        value: of the parameter.
        error: its standard error.
    """

    value: float
    error: float


@dataclass(frozen=True)
class Signature:
    """What an effect adds to the residuals of one run.

    Attributes:
        columns: per channel (g, d, p), one column for each coefficient.
        fixed: per channel (g, d), the part without a coefficient.
    """

    columns: dict[Channel, Array] = field(default_factory=dict)
    fixed: dict[Channel, Array] = field(default_factory=dict)


class Best(NamedTuple):
    """The excitation of the standard set that shows an effect best, and why."""

    excitation: str
    why: str


class Effect:
    """Base of every effect; a subclass is a page in a file of its own.

    Class attributes:
        id, family, stage: of the recorded-run contract, section 7.
        explanation: plain language: what it is and how it shows.
        places: kinds of place it may sit on; a machine says which of its sites are such a place.
        kinds: kinds of machine this form of the effect is written for, of `KINDS`.
        needs: facts that must be known of an axis before the effect can be looked for: "lead" its travel per motor
            revolution, "load" a second encoder behind the transmission, "temperature" of the axis, "mass" its mass,
            "drive" the force it is driven with, "forces" what the motion needs of it: mass, weight or a model of the
            user's, "orientation" how a sensor is turned, "alone" that its only encoder is at the motor, "behind" that
            it is at the load, "applied" a known force on the axis from outside, "held" that a servo is asked for a
            place, "asked speed" that it is asked for a speed.
        seen_at: (stage, place) of the channels in which it must show to be looked for; "" is its own stage or its site.
        inputs: quantities the law may depend on, of `INPUTS`; none for an error that is constant.
        gives: parameters by name: those that its shape has are the shape's, the others its coefficients in their order,
            of which a shape may have fewer.
        tried: shapes to search over that are the same on every machine.
        units: parameter -> SI unit on a linear axis.
        bent_from: share of what a law with a bend explains that the one without must leave for the bend to be named.
        discrete: parameters that are a choice (a source, a member, a number of periods) and have no interval.
        choices: parameter of `discrete` -> value -> what it means, in a word.
        bounds: parameter -> smallest and largest value that is physically possible.
        above: what its first coefficient must exceed: a friction resists, a gain keeps its sign.
        extends_by: parameters that must differ from zero for the effect to be told from a simpler one that it extends.
        siblings: effect id -> what tells it from this one.
        extends: ids of simpler effects that this one contains; it must explain markedly more than they do.
        finer: shape value -> factors by which the best value is multiplied in the finer search.
        polished: shape values beside those of `finer` that are no choice: polished once the search is over.
        companion: family of another effect on the same axis without which this one does not show.
        shown_by: families of effects on the same axis that bring this one to light; it comes after them.
        plain: whether it is one of the laws that any joint may have: all of them are fitted at once before a richer one
            is looked for.
        dry: whether it is a friction that holds an axis at rest.
        amount: value of a shape that says how much of the effect there is; "" where a coefficient does.
        slow: whether its law lives at low speed, so that samples in quick motion tell nothing of its parameters.
        unseen: whether it is behind the only encoder of an axis, where the effort alone shows it.
        about: values of a shape that the fit finds again by itself, since its columns are linear about them; no more
            numbers of its own.
        scales: the known force that it multiplies, in words ("drive gain", "weight", "payload"); no motion tells such
            effects of one joint apart while its drive gain is not known.
        indistinct: ids of effects that give the same readings where the force was not recorded.
        of_recorder: whether only a recorder makes it: its law is exact, and what a simulator logs, it knows at once.
        parted_by_travel: share of what it explains by which it differs, over the recorded travel, from other forces
            that follow the position; 0 for an effect that is none.
        settles: whether its parameters are of sliding alone, so that samples at which it rests tell nothing of them.
        best: the excitation that shows it best.
        leaves_out: what a real machine adds to the idealised law, in words. Empty for a law of geometry, mechanics or
            arithmetic that a machine follows to a few percent: there much left over speaks against the effect.
        condition: under which alone it acts, where runs were recorded under several; None: in all runs.
    """

    id: ClassVar[str]
    family: ClassVar[str]
    stage: ClassVar[str]
    explanation: ClassVar[str]
    places: ClassVar[tuple[str, ...]] = ("axis",)
    kinds: ClassVar[tuple[str, ...]] = ("robot",)
    needs: ClassVar[tuple[str, ...]] = ()
    seen_at: ClassVar[tuple[tuple[str, str], ...]] = (("", ""),)
    inputs: ClassVar[tuple[str, ...]] = ()
    gives: ClassVar[tuple[str, ...]] = ()
    tried: ClassVar[Sequence[Shape]] = ({},)
    units: ClassVar[Mapping[str, str]] = {}
    bent_from: ClassVar[float] = RIVAL
    discrete: ClassVar[frozenset[str]] = frozenset()
    choices: ClassVar[Mapping[str, Mapping[float, str]]] = {}
    bounds: ClassVar[Mapping[str, tuple[float, float]]] = {}
    above: ClassVar[float] = -math.inf
    extends_by: ClassVar[tuple[str, ...]] = ()
    siblings: ClassVar[Mapping[str, str]] = {}
    extends: ClassVar[tuple[str, ...]] = ()
    finer: ClassVar[Mapping[str, tuple[float, ...]]] = {}
    polished: ClassVar[tuple[str, ...]] = ()
    companion: ClassVar[str] = ""
    shown_by: ClassVar[tuple[str, ...]] = ()
    plain: ClassVar[bool] = False
    of_recorder: ClassVar[bool] = False
    dry: ClassVar[bool] = False
    amount: ClassVar[str] = ""
    slow: ClassVar[bool] = False
    unseen: ClassVar[bool] = False
    about: ClassVar[tuple[str, ...]] = ()
    scales: ClassVar[str] = ""
    indistinct: ClassVar[tuple[str, ...]] = ()
    parted_by_travel: ClassVar[float] = 0.0
    settles: ClassVar[bool] = False
    best: ClassVar[Best]
    leaves_out: ClassVar[str] = ""
    condition: str | None = None

    @property
    def ordinary(self) -> bool:
        """Whether its law is one that any joint or its recorder may have: such laws are fitted at once."""
        return self.plain or self.of_recorder

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Return the channels in which the effect must show to be looked for at a site."""
        return tuple(Channel(stage or self.stage, place or site) for stage, place in self.seen_at)

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return the shapes to search over; empty when the runs cannot show the effect; default those of `tried`."""
        return [*self.tried]

    def plain_shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return the shapes in which a plain law is fitted beside all others; default all of them."""
        return self.shapes(views, site)

    def allowed(self, views: Sequence[Any], site: str, shape: Shape) -> bool:
        """Return whether the runs can hold a shape that a finer search came to; default any."""
        return True

    def scales_model(self, shape: Shape) -> bool:
        """Return whether a shape is a share of what the model says: where that is found from the data, none is told."""
        return False

    def bends(self, views: Sequence[Any], site: str, shape: Shape) -> list[Shape]:
        """Return shapes of the law with a bend that some machines have, near the best one without; default none."""
        return []

    def refine(self, shape: Shape) -> list[Shape]:
        """Return neighbours of the best shape for a finer search: one value at a time times its factors."""
        return [
            {**shape, name: shape[name] * factor}
            for name, factors in self.finer.items()
            for factor in factors
            if shape.get(name)  # a value of zero has no neighbours, nor has one that this shape does without
        ]

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return what the effect adds to the residuals of one run at a site; every page that is fitted has its own.

        Raises:
            NotImplementedError: the page has none.
        """
        raise NotImplementedError

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the parameters of coefficients (p,), SI units; default those it `gives`, else the shape's values."""
        names = [name for name in self.gives if name not in shape]
        known = {**shape, **dict(zip(names, map(float, coefficients), strict=False))}
        return {name: known[name] for name in self.gives or shape if name in known}

    def free(self) -> Effect | None:
        """Return the law with a coefficient for each number, where this one's are found beforehand; default None."""
        return None

    def found(self, each: Mapping[str, Measured]) -> Shape:
        """Return the shape of numbers that were found beforehand, by name, with their standard errors."""
        return {name: x.value for name, x in each.items()}

    def measured(self, views: Sequence[Any], site: str, shape: Shape) -> Mapping[str, Measured]:
        """Return parameters that other means than the fit tell better, by name; default none."""
        return {}

    def in_words(self, view: Any, values: Mapping[str, float]) -> str:
        """Return what fitted parameters mean on this machine, for the notes; default nothing."""
        return ""

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether coefficients (p,) are physically possible; default where the first is above `above`."""
        return self.above == -math.inf or bool(coefficients[0] > self.above)

    def plainer(self, views: Sequence[Any], site: str, shape: Shape) -> list[Shape]:
        """Return shapes of fewer numbers that take a shape's place where its numbers have no size; default none."""
        return []

    def limits(self, shape: Shape) -> Mapping[str, tuple[float, float]]:
        """Return parameter -> smallest and largest value that may be in its interval; default the bounds."""
        return self.bounds

    def held(self, view: Any, site: str, shape: Shape, coefficients: Array) -> Array | None:
        """Return the force (g,) up to which the law holds anything, 0 where the record tells its state; default None.

        A dry friction holds an axis at rest with whatever is needed, up to its level: no motion tells that force.
        """
        return None

    def stage_at(self, channel: Channel) -> str:
        """Return the stage a cause is booked under when it shows in `channel`; default the page's."""
        return self.stage

    def unit(self, name: str, site: str, rotary: bool) -> str:
        """Return the unit of a parameter at a site; `rotary` where that is an axis that turns."""
        unit = self.units.get(name, "1")
        return ROTARY.get(unit, unit) if rotary else unit


def within(limits: Mapping[str, tuple[float, float]], told: Mapping[str, Sequence[float]]) -> bool:
    """Return whether every value that is told of a parameter lies within its limits; one without may be anything."""
    return all(least <= x <= most for name, (least, most) in limits.items() for x in told.get(name, ()))


def column(*parts: Array) -> Array:
    """Stack (g,) columns into (g, 1, p)."""
    return np.stack(parts, axis=-1)[:, None, :]
