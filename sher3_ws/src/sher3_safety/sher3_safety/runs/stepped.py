"""The matrix in stepped time: every node, the CAN frames and all topics in one process, faults one after another.

Each cell: the robot does what its state says; the fault sets in; what happens is recorded; the fault ends with the
pedal still pressed; after a stop the operator recovers the robot, enables it, only then releases the pedal, and
presses it again. What that shows is read from the bag (`sher3_safety.measurement.recording`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from random import Random
from typing import Any

from sher3_bags.reading import read_run
from sher3_bags.recording.live import recorded
from sher3_bags.run import RunMetadata
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_common import Sher3Error
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_control.settings import ControlSettings
from sher3_description import Robot
from sher3_drivers.settings import default_settings
from sher3_faults.items import Numbers, Stamps
from sher3_faults.kinds import KINDS, OFF, OK, Kind
from sher3_faults.requests import make_request
from sher3_runtime import Graph
from sher3_runtime.ports import ports

from sher3_safety.measurement.recording import STANDS, Outcome, Recording
from sher3_safety.rows.row import FURTHER, LOST, STATES, Row, State
from sher3_safety.runs.operator_node import OperatorNode

SETTLE, APPROACH, OBSERVE, HELD, RELEASED, AGAIN = 60, 90, 40, 60, 15, 40
"""Ticks: before the first `enable`; until the tip has the speed of the state; observed after a fault; enabled with
the pedal still pressed, six times the 20 ms in which drives take up a hand; with the pedal released; with the pedal
pressed again."""
LEAVES = {OperatingState.PAUSED: StateCommand.PAUSE.value, OperatingState.DISABLED: StateCommand.DISABLE.value}
"""Commands that lead from ENABLED to the states in which a fault sets in."""
ENABLE_TRIES, ENABLE_TICKS = 16, 30
GRACE = 300
"""Ticks after a recovery until the supervisor listens to the motor driver again, and some more."""
STOPS = {"code": float(0x8611)}
"""EMCY with which a drive stops the robot that is then recovered."""
TRAVEL = 4e-3
"""Travel of the sliders to either side [m] where the robot has to be at the end of it: the real end is 38 mm and 8 s
away at the speed limit."""
LONGEST, ARRIVED, PULL = 1200, 5e-6, 1.0
"""Most ticks to the end of the travel; the tip has arrived when it moves by less than this in `SETTLE` ticks [m]; force
of the hand on the way back [N]."""

Cell = tuple[Row, State]


class MatrixRun:
    """A robot on which faults are tried."""

    def __init__(self, graph: Graph, robot: Robot, seed: int, composed: bool = False, regime: str = "free") -> None:
        self.graph, self.seed = graph, seed
        self.operator = graph.add(OperatorNode)
        control = ControlSettings.from_robot(robot, {"motion": {"regime": regime}})
        drives = default_settings(robot.control_period)
        self.rig = SteppedRobot(graph, seed=seed, robot=robot, control=control, drives=drives, composed=composed)
        self._sign = 1.0

    def start(self) -> bool:
        """Enable the robot; return whether it is."""
        self.graph.step(SETTLE)
        # The plant tells the truth from the first request on.
        self.inject(make_request(component="all", fault=OK).to_json())
        return self.enable()

    def play(self, row: Row, state: State) -> bool:
        """Play one cell; return whether the robot is ready for the next one."""
        operator, label = self.operator, row.label(state)
        self._sign = 1.0 if state.end else -self._sign
        if state.end:
            self._go_to_end(self._sign * state.force)
        operator.force, operator.pedal = self._sign * state.force, state.pedal
        operator.across = self._sign * state.across
        self.graph.step(APPROACH)
        if state.operating is not OperatingState.ENABLED:
            operator.command(LEAVES[state.operating])
            self.graph.step(SETTLE)
        if row.since:
            self._enable_under(row, state, label)
        elif row.release:
            self._release_under(row, label)
        else:
            self.inject(row.request(self.seed, label).to_json())
        if row.beside is not None:
            self.inject(row.beside.request(self.seed, "", row.after).to_json())
        operator.force *= not row.lets_go
        operator.aim = (state.aim,) * 3 + (0.0, 0.0) if state.aim else None
        duration = OBSERVE if row.duration is None else round(row.duration * 1e9 / self.graph.clock.period_ns)
        self._go_through(row, duration)
        self.graph.step(OBSERVE)
        operator.aim = None
        self.inject(make_request(component=row.component, fault=OK, label=label).to_json())
        if row.beside is not None:
            self.inject(make_request(component=row.beside.component, fault=OK).to_json())
        if row.final:
            self.graph.step(5)
            return False
        if row.loses:
            self.inject(make_request(component=row.loses, fault=OFF, duration=LOST).to_json())
        if row.expects == "goes on" and operator.state == OperatingState.ENABLED:
            self.graph.step(5)
            operator.pedal = 0.0
            self.graph.step(RELEASED)
            return True
        hand = -self._sign * PULL if state.end or not operator.force else operator.force
        return self._recover(hand, RELEASED + round(row.rest / self.rig.robot.control_period))

    def _go_to_end(self, force: float) -> None:
        """Push the sliders to the end of their travel."""
        self.operator.force, self.operator.pedal = force, 1.0
        for _ in range(0, LONGEST, SETTLE):
            before = self.operator.height
            self.graph.step(SETTLE)
            if abs(self.operator.height - before) < ARRIVED:
                return

    def _release_under(self, row: Row, label: str) -> None:
        """Release the pedal under a fault, and measure from there.

        The fault sets in first, so that a stuck pedal is stuck while it is pressed.
        """
        self.inject(row.request(self.seed, "").to_json())
        if not row.component.startswith("process."):
            self.graph.step(2)
        note = make_request(component="process.plant", fault=row.fault, label=label)
        self.inject(note.to_json())
        self.operator.pedal = 0.0

    def _enable_under(self, row: Row, state: State, label: str) -> None:
        """Enable the robot with the fault there, let the hand come, and measure from the first press of the pedal on.

        What was noticed at once is cleared first, as somebody would who does not ask why.
        """
        operator, hand = self.operator, (self.operator.force, self.operator.across)
        operator.force = operator.across = operator.pedal = 0.0
        if row.since == "recovery":
            self.inject(make_request(component="roll.demand", fault="wrong", duration=0.01, parameters=STOPS).to_json())
            self.graph.step(SETTLE)
        else:
            self._disable()
        self.inject(row.request(self.seed, "").to_json())
        self._disable()
        self.enable(2)
        operator.force, operator.across = hand
        self.graph.step(HELD)
        self.inject(make_request(component="process.plant", fault=OFF, label=label).to_json())
        operator.pedal = state.pedal

    def _disable(self) -> None:
        """Disable or recover the robot, and wait until the motor driver's reports count again."""
        self.operator.command(StateCommand.DISABLE.value)
        self.graph.step(GRACE)

    def inject(self, request: str) -> None:
        """Send a request for a fault, and let it arrive."""
        self.operator.inject(request)
        self.graph.settle()

    def _recover(self, force: float, released: int) -> bool:
        """Leave FAULT with the hand off, enable with the pedal still pressed, release it for so long, press it again.

        Args:
            force: of the hand after the release, N; it takes hold again while the pedal is still pressed.
            released: ticks.
        """
        held = self.operator.force, self.operator.across
        self.operator.force = self.operator.across = 0.0
        self.operator.command(StateCommand.DISABLE.value)
        self.graph.step(5)
        if not self.enable():
            return False
        self.operator.force, self.operator.across = held
        self.graph.step(HELD)
        self.operator.pedal = 0.0
        self.graph.step(released)
        self.operator.pedal, self.operator.force = 1.0, force
        self.graph.step(AGAIN)
        self.operator.pedal = 0.0
        self.graph.step(RELEASED)
        return True

    def enable(self, tries: int = ENABLE_TRIES) -> bool:
        """Enable the robot, in some tries at most; return whether it is."""
        for _ in range(tries):
            self.operator.command(StateCommand.ENABLE.value)
            self.graph.step(ENABLE_TICKS)
            if self.operator.state == OperatingState.ENABLED:
                return True
            self.operator.command(StateCommand.DISABLE.value)
            self.graph.step(2)
        return False

    def _go_through(self, row: Row, ticks: int) -> None:
        """Let the time of the fault pass; hold nodes and let clocks jump, which the plant process cannot do."""
        what, _, name = row.component.partition(".")
        if row.fault == "duplicated" and what == "process":
            self._start_again(name, ticks)
        elif what == "process":
            self._hold(getattr(self.rig, name), row, ticks)
        elif what == "clock" and name:
            with self._other_clock(name, row):
                self.graph.step(ticks)
        else:
            if what == "clock":
                self.graph.jump(row.parameters["offset"])
            self.graph.step(ticks)

    def _start_again(self, name: str, ticks: int) -> None:
        """Start a process a second time; it may refuse, and then nothing has changed."""
        try:
            self.rig.start_again(name)
        except Sher3Error as error:
            self.operator.get_logger().info(f"{name} did not start twice: {error}")
        self.graph.step(ticks)

    def _hold(self, node: Any, row: Row, ticks: int) -> None:
        """Let a process run only in the ticks that the fault lets pass; a killed process never runs again."""
        name = "off" if row.fault == "stuck" else row.fault
        fault = KINDS[name](Numbers(0.0), row.parameters, Random(f"{self.seed}"))
        held = False
        for tick in range(ticks):
            holds = not fault([float(tick)], tick * self.graph.clock.period_ns)
            if holds != held:
                (self.graph.pause if holds else self.graph.resume)(node)
                held = holds
            self.graph.step()
        if held and row.fault != "off":
            self.graph.resume(node)

    @contextmanager
    def _other_clock(self, name: str, row: Row) -> Iterator[None]:
        """Give one node another clock: its ticks get the stamps that the fault makes of the true ones."""
        before = {}
        for tick in ports(getattr(self.rig, name)).ticks:
            before[tick] = tick.callback
            fault = KINDS[row.fault](Stamps(), row.parameters, Random(f"{self.seed}"))
            tick.callback = partial(_tick_through, fault, tick.callback)  # type: ignore[method-assign]
        yield
        for tick, call in before.items():
            tick.callback = call


def _tick_through(fault: Kind, call: Callable[[int], None], stamp: int) -> None:
    for told in fault([stamp], stamp):
        call(told)


def _pushed(cells: Sequence[Cell]) -> Callable[[str], bool]:
    """Return which labels are of cells in which a robot is led off by a hand after it was enabled."""
    labels = {row.label(state) for row, state in cells if row.since}
    return labels.__contains__


def _stands(label: str) -> float:
    return STANDS * next(state.budget for state in (*STATES, *FURTHER) if label.endswith(f"| {state.name}"))


def run_cells(
    name: str, cells: Sequence[Cell], robot: Robot, folder: Path, seed: int = 1, composed: bool = False
) -> dict[str, Outcome]:
    """Run cells one after another and return their outcomes by label; bags are `folder/<name>`, `<name>-1`, ...

    A robot that a fault has left beyond recovery is replaced by a new one, with a bag of its own; so is the robot for
    the end of the travel (`<name>-end`), whose sliders have a shorter one. `composed`: the nodes of the loop share a
    process.
    """
    inside, at_end = ([cell for cell in cells if cell[1].end is end] for end in (False, True))
    found = _run_all(name, inside, robot, folder, seed, composed)
    return found | _run_all(f"{name}-end", at_end, with_travel(robot, TRAVEL), folder, seed, composed)


def with_travel(robot: Robot, travel: float) -> Robot:
    """Return the robot with sliders of the delta that go no further than `travel` [m] either way."""
    sliders = [a.model_copy(update={"limits": a.limits.model_copy(update={"lower": -travel, "upper": travel})})
               for a in robot.actuators[:3]]  # fmt: skip
    return robot.model_copy(update={"actuators": (*sliders, *robot.actuators[3:])})


def _run_all(
    name: str, cells: Sequence[Cell], robot: Robot, folder: Path, seed: int, composed: bool
) -> dict[str, Outcome]:
    """Run cells one after another, with new robots where one is beyond recovery."""
    left, found, number = list(cells), dict[str, Outcome](), 0
    while left:
        bag = f"{name}-{number}" if number else name
        count = _run_some(bag, left, robot, folder, seed, composed)
        recording = Recording(read_run(folder / bag, check=False), robot, robot.control_period)
        for outcome in recording.outcomes(_stands, _pushed(left)):
            found[outcome.label] = outcome
        left, number = left[count:], number + 1
    return found


def _run_some(bag: str, cells: Sequence[Cell], robot: Robot, folder: Path, seed: int, composed: bool) -> int:
    """Run cells on a new robot until one is beyond recovery; return how many were run."""
    metadata = RunMetadata(excitation="faults", origin="plant", seed=seed)
    with Graph(period=robot.control_period, middleware=False) as graph:
        run = MatrixRun(graph, robot, seed, composed)
        with recorded(graph, bag, robot=robot, root=folder, metadata=metadata):
            run.start()
            for count, (row, state) in enumerate(cells, 1):
                if not run.play(row, state):
                    return count
    return len(cells)
