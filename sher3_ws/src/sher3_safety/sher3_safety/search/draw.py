"""What the search draws: two or three faults, how large, of which axis, when against each other, and in which state.

Sizes are drawn evenly over their decades, onsets to the tick. Left out are faults whose residual is stated and which
would always win: a force sensor that is false and small, a pedal that hangs, a motor that turns without power, an axis
that goes by itself while both its encoders drift.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from random import Random
from typing import NamedTuple

from sher3_common.operating_state import OperatingState
from sher3_control.motion.speed_cap import Regime
from sher3_description import ACTUATORS
from sher3_faults.budget import CUT_OFF, RUNAWAY
from sher3_faults.requests import GROUPS, FaultRequest, make_request

from sher3_safety.rows.row import IDLE, LIMIT, MOVING, PAUSED, State

ONSETS, LASTS = 60, 0.3
"""Largest onset of a later fault [ticks]: the braking time and more; duration of a fault [s]."""
SHAKES = 1e-5
"""Largest jitter of an encoder [m, rad]: more than its own check lets pass of a leg, 7 um."""
STATES = {Regime.NEAR_TISSUE: (IDLE, MOVING, PAUSED), Regime.FREE: (IDLE, MOVING, LIMIT, PAUSED)}
LEG, ROLL, TILT = (2e-3, 12.2e-3), (0.03, 0.3), (9e-4, 9e-3)
"""Limits of the drives near tissue and free [m/s, rad/s]."""
CAPS = dict(zip(ACTUATORS, (LEG, LEG, LEG, ROLL, TILT), strict=True)) | {"legs": LEG, "axes": TILT}


class Shape(NamedTuple):
    """A fault that can be drawn: part of an axis or a whole component, kind, and the parameter that is its size."""

    part: str
    kind: str
    size: str = ""
    value: float = 0.0


RUNAWAYS = (Shape("power", "creep", "speed"), Shape("demand", "creep", "speed"))
DRIFT = Shape("encoders", "drift", "rate")
"""What hides the first of them: both encoders stay, and the echo does, while the axis goes."""
WITH_AXIS = (
    *RUNAWAYS,
    Shape("echo", "stuck"),
    Shape("echo", "wrong", "scale", 0.0),
    Shape("load_encoder", "stuck"),
    Shape("motor_encoder", "stuck"),
    Shape("load_encoder", "drift", "rate"),
    Shape("motor_encoder", "drift", "rate"),
    DRIFT,
    Shape("load_encoder", "jitter", "size"),
    Shape("encoders", "jitter", "size"),
    Shape("power", "wrong", "scale", -1.0),
    Shape("power", "wrong", "scale", 1.02),
)
DRAWN = ("speed", "rate", "size")
"""Parameters whose size is drawn."""
CUTS = (Shape("", "off"), Shape("bus", "off"))
"""Faults after which a drive neither hears nor is heard."""
OF_ONE = (Shape("demand", "wrong", "code", float(0x8611)), CUTS[0], Shape("up", "late"), Shape("up", "off"))
WHOLE = (Shape("pedal", "off"), CUTS[1], Shape("bus.up", "late"), Shape("force_sensor", "off"))


@dataclass(frozen=True)
class Fault:
    """One drawn fault; `share` is its size as a share of the drive's limit, `onset` in ticks."""

    component: str
    shape: Shape
    share: float
    onset: int

    @property
    def axes(self) -> tuple[str, ...]:
        """The axes that it acts on."""
        unit = self.component.partition(".")[0]
        return ACTUATORS if unit == "bus" else GROUPS.get(unit, (unit,))

    def full(self, regime: Regime) -> float:
        """Return the size of which `share` is a part: limit of the drive [m/s, rad/s], or largest jitter [m, rad]."""
        if self.shape.size == "size":
            return SHAKES
        return CAPS.get(self.component.partition(".")[0], LEG)[regime is Regime.FREE]

    def request(self, regime: Regime, period: float) -> FaultRequest:
        """Return what is sent on `mock/fault`."""
        size = self.share * self.full(regime)
        drawn_sizes = {"speed": size, "rate": size, "size": abs(size)}
        value = drawn_sizes.get(self.shape.size, self.shape.value)
        parameters = {self.shape.size: value} if self.shape.size else {}
        return make_request(component=self.component, fault=self.shape.kind, start=self.onset * period, duration=LASTS,
                            parameters=parameters)  # fmt: skip

    def in_words(self, regime: Regime, digits: int) -> str:
        """Return the fault in words."""
        request = self.request(regime, 0.002)
        sizes = "".join(f" {name} {value:.{digits}g}" for name, value in request.parameters.items())
        return f"{self.component} {self.shape.kind}{sizes} at {self.onset}"


@dataclass(frozen=True)
class Draw:
    """Faults that are tried together."""

    faults: tuple[Fault, ...]
    state: State
    regime: Regime

    @property
    def budget(self) -> float:
        """Travel that is allowed [m]; of an axis that goes by itself while its drive is cut off, what is stated."""
        return (CUT_OFF if self._axes(CUTS) & self._axes(RUNAWAYS) else RUNAWAY)[self.regime]

    @property
    def hidden(self) -> bool:
        """Whether an axis goes by itself while both its encoders drift."""
        return bool(self._axes(RUNAWAYS[:1]) & self._axes([DRIFT]))

    def _axes(self, shapes: Sequence[Shape]) -> set[str]:
        """Return the axes that faults of these shapes act on."""
        return {axis for fault in self.faults if fault.shape in shapes for axis in fault.axes}

    @property
    def paused(self) -> bool:
        """Whether motion is paused."""
        return self.state.operating is OperatingState.PAUSED

    def in_words(self, digits: int = 5) -> str:
        """Return the faults in words, with sizes of so many digits."""
        return "; ".join(fault.in_words(self.regime, digits) for fault in self.faults)

    def line(self, digits: int = 5) -> str:
        """Return the draw as a line of a table, which `search.words` reads."""
        return f"{self.regime.value} | {self.state.name} | {self.in_words(digits)}"


def drawn(random: Random, regime: Regime) -> Draw:
    """Return two or three faults, the first one an axis, or several, that goes by itself."""
    faults = [_fault(random, random.choice(RUNAWAYS))]
    while len(faults) < random.choice((2, 2, 3)):
        more = _fault(random, random.choice((*RUNAWAYS, *WITH_AXIS, *OF_ONE, *WHOLE)))
        if more.component not in [fault.component for fault in faults]:
            faults.append(more)
    found = Draw(_from_zero(faults), random.choice(STATES[regime]), regime)
    return drawn(random, regime) if found.hidden else found


def _fault(random: Random, shape: Shape) -> Fault:
    names = ACTUATORS if shape in OF_ONE else (*ACTUATORS, "legs", "axes")
    component = shape.part if shape in WHOLE else f"{random.choice(names)}.{shape.part}".rstrip(".")
    size = math.copysign(10.0 ** random.uniform(-3.0, 0.0), random.uniform(-1.0, 1.0))
    return Fault(component, shape, size, random.randint(0, ONSETS))


def near(random: Random, draw: Draw) -> Draw:
    """Return a draw near another one: sizes up to a factor of two, onsets up to three ticks off, perhaps its state."""
    faults = [
        replace(fault, share=max(-1.0, min(1.0, fault.share * 2.0 ** random.uniform(-1.0, 1.0))),
                onset=max(0, min(ONSETS, fault.onset + random.randint(-3, 3))))
        for fault in draw.faults
    ]  # fmt: skip
    state = random.choice(STATES[draw.regime]) if random.random() < 0.2 else draw.state
    return replace(draw, faults=_from_zero(faults), state=state)


def _from_zero(faults: list[Fault]) -> tuple[Fault, ...]:
    """Let the first of the faults begin at once."""
    first = min(fault.onset for fault in faults)
    return tuple([replace(fault, onset=fault.onset - first) for fault in faults])
