"""The matrix as data: which fault of which component, in which state, and what must come of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Literal

from sher3_common.operating_state import OperatingState
from sher3_description import ACTUATORS
from sher3_faults.requests import FaultRequest, make_request

Expected = Literal["stops", "goes on", "either", "residual", "ends", "said", "barred"]
Since = Literal["", "enabling", "recovery"]
DETECTION_LIMIT, STOP_LIMIT = 0.050, 0.100
"""Longest times [s] from the onset of a fault to the first reaction and to rest. In 50 ms the tip travels the whole
budget: 250 um at 5 mm/s, 25 um at 0.5 mm/s."""

LOST = 0.1
"""Time for which frames are lost in a recovery [s]: fifty of them, a fifth of the time that a drive has for it."""


@dataclass(frozen=True)
class State:
    """What the robot does when the fault sets in.

    Attributes:
        speed: of the tip [m/s].
        force: of the hand along +-z, N; along x or y the moment at the sensor would saturate it first.
        pedal: travel.
        budget: largest allowed travel [m].
        end: the hand has pushed the sliders against the end of their travel, and still pushes.
        operating: operating state.
        aim: how far from where they are `command/servo_jp` asks the sliders to be, from the onset on, m.
        across: force of the hand along x, N.
        later: how much later than usual a fault may be noticed and the tip rest, s; with a budget of its own.
    """

    name: str
    speed: float
    force: float
    pedal: float
    budget: float
    end: bool = False
    operating: OperatingState = OperatingState.ENABLED
    aim: float = 0.0
    later: float = 0.0
    across: float = 0.0


IDLE = State("idle", 0.0, 0.6, 0.0, 25e-6)
MOVING = State("moving", 0.5e-3, 0.6, 1.0, 25e-6)
LIMIT = State("at limit", 5e-3, 6.0, 1.0, 250e-6)
END = State("at end", 0.0, 6.0, 1.0, 250e-6, end=True)
STATES = (IDLE, MOVING, LIMIT, END)
"""Enabled and at rest under a hand; at the speed near tissue; at the speed limit; pushed against the end of the travel,
as fast as at the speed limit were there no end."""
PAUSED = State("paused", 0.0, 0.6, 0.0, 25e-6, operating=OperatingState.PAUSED)
DISABLED = State("disabled", 0.0, 0.6, 0.0, 25e-6, operating=OperatingState.DISABLED)
AIMING = State("aiming", 0.0, 0.0, 0.0, 25e-6, aim=15e-6)
FIRM = State("firm", 0.5e-3, 1.0, 0.5 / 0.9, 25e-6)
LIGHT = State("light", 0.5e-3, 0.6, 1.0, 140e-6, later=0.22)
SIDEWAYS = State("sideways", 0.5e-3, 0.0, 1.0, 25e-6, across=0.6)
NOBODY = State("nobody", 0.0, 0.0, 1.0, 100e-6)
FURTHER = (PAUSED, DISABLED, AIMING, FIRM, LIGHT, SIDEWAYS, NOBODY)
"""States for some rows only: held by the drives while motion is paused; without power; a position mode with an aim that
the axes are not at yet; at the speed near tissue under a hand that is to leave, a firm and a light one, of which
the noise of the drives' forces does not allow to be sure any sooner; at that speed along x, where each leg moves at
another speed; the pedal pressed and nobody at the handle, so that all travel is the sensor's."""
STILL = (IDLE.name, END.name)
"""States in which nothing moves."""
AT_END = 1e-3
"""Largest distance from the end of its travel at which an axis counts as at it, as a share of the travel."""


@dataclass(frozen=True)
class Row:
    """One fault of one component, in every state.

    Attributes:
        expects: what has to happen. `stops`: the robot stops in time and within the budget, and moves again only when
            the operator asks for it. `goes on`: it does not stop, and the tip stays within the budget of its
            undisturbed path. `either`: chance decides between the two. `residual`: no detector can see the fault, so
            the travel is only stated. `ends`: the emulated robot itself has ended and there is no tip to measure; the
            fault must be reported, and FAULT entered, in time. `said`: no software can stop it; it is reported in time
            and for one of `reasons`, and the travel is stated. `barred`: the robot cannot be enabled.
        since: the fault is there before the robot is enabled, or before it is recovered from another stop; then the
            hand comes, and what counts is how far the tip is off the way of the hand from the first press on.
        duration: of the fault, s; None: until it is taken away.
        reasons: the first reported reason, or that of the FAULT (`ends`), must be one of these; empty where nobody
            needs to notice (`goes on`).
        quiet: states in which the fault need not be noticed, since nothing can move.
        quick: belongs to the compact set of the default test run.
        release: the operator releases the pedal as the fault sets in; whatever the fault, the tip has to stop.
        slow: the fault grows so slowly that its distance counts, not its time: how far the tip is off its undisturbed
            path, against the budget, whenever that is noticed.
        budget: travel allowed instead of the budget of the state, m; `why` gives the reason.
        rest: how much longer than usual the foot stays off the pedal before it is pressed again, s.
        lets_go: the hand leaves as the fault sets in.
        beside: a second fault, with its own component, kind, parameters and duration.
        after: how much later than the first one the second one begins, s.
        loses: component that is off when the operator recovers the robot, for `LOST` seconds.
        states: in which it is tried.
        why: why the robot may go on, a sentence for the report.
    """

    component: str
    fault: str
    parameters: Mapping[str, float] = field(default_factory=dict)
    expects: Expected = "stops"
    reasons: tuple[str, ...] = ()
    duration: float | None = 0.12
    quiet: tuple[str, ...] = ()
    quick: bool = False
    release: bool = False
    slow: bool = False
    budget: float | None = None
    rest: float = 0.0
    lets_go: bool = False
    beside: Row | None = None
    after: float = 0.0
    loses: str = ""
    since: Since = ""
    states: tuple[State, ...] = STATES
    why: str = ""

    @property
    def name(self) -> str:
        """Component, fault, parameters, and what the operator does."""
        parts = [f"{name} {value:g}" for name, value in self.parameters.items()]
        name = f"{self.component} {self.fault}" + (f" ({', '.join(parts)})" if parts else "")
        lost = f", {self.loses} lost" if self.loses else ""
        lost += f", there at {self.since}" if self.since else ""
        lost += f", {self.after * 1e3:g} ms later {self.beside.name}" if self.beside else ""
        return name + ", pedal released" * self.release + ", hand gone" * self.lets_go + lost

    @property
    def final(self) -> bool:
        """Whether the robot is given up afterwards: a process was killed, or runs twice."""
        return self.component.startswith("process.") and self.fault in ("off", "duplicated")

    def label(self, state: State) -> str:
        """Return what this row in a state is called in its bag."""
        return f"{self.name} | {state.name}"

    def request(self, seed: int, label: str, start: float = 0.0) -> FaultRequest:
        """Return what is sent on `mock/fault`, for a fault that begins `start` s later; one that is there stays."""
        return make_request(
            component=self.component,
            fault=self.fault,
            parameters=dict(self.parameters),
            start=start,
            duration=None if self.since else self.duration,
            seed=seed,
            label=label,
        )


def select(rows: tuple[Row, ...], only: str = "", quick: bool = False) -> Iterator[Row]:
    """Yield the rows of a component (a prefix of its name), or of the compact set."""
    for row in rows:
        if row.component.startswith(only) and (row.quick or not quick):
            yield row


AXIS = ACTUATORS[0]
