"""Invariants over every reachable state of the product of all state machines; `product_machine` says what is wired."""

from dataclasses import dataclass, field

import pytest
from product_machine import Exploration, explore
from product_world import COMMANDS, EVENTS, HARMLESS, LOSSY, World
from sher3_common.operating_state import OperatingState as S
from sher3_common.reasons import Action
from sher3_description import ACTUATORS
from sher3_drivers.mock import drive as mock_drive

RARE = frozenset({"overruns", "in time", "bus passive", "drive loses power stage"})
FEW = ("tick", "enable", "disable", "press", "release", "drive faults")
DEFAULT = tuple(event for event in EVENTS if event not in RARE)


@dataclass
class Checked:
    """An exploration whose every transition kept the invariants."""

    result: Exploration
    resting: set[int] = field(default_factory=set)
    moving: set[int] = field(default_factory=set)
    seen: dict[str, int] = field(default_factory=dict)


def check(before: World, event: str, after: World, accepted: bool, seen: dict[str, int]) -> None:
    """The invariants of one transition; `seen` counts how often each had something to say."""

    def holds(name: str, when: bool, what: bool) -> None:
        if when:
            seen[name] = seen.get(name, 0) + 1
            assert what, f"{name}: {before.key()} --{event}--> {after.key()}"

    moving, faulty = any(after.demands), after.faulty
    holds("motion only ENABLED", moving, after.state is S.ENABLED)
    holds("motion only released then pressed", moving, after.released and after.pressed and after.law.armed)
    holds("motion only when nothing is wrong", moving, not faulty)
    holds("all drives or none", moving, len({bool(d) for d in after.demands}) == 1)
    holds("a fault brings standstill at once", faulty, not moving)
    holds("no re-enabling", before.state is not S.ENABLED and after.state is S.ENABLED, event in ("enable", "resume"))
    leaves = before.state is S.FAULT and after.state is not S.FAULT
    holds("FAULT is left by disable alone", leaves, event == "disable" and accepted and after.state is S.DISABLED)
    holds("FAULT refuses all else", before.state is S.FAULT and event in COMMANDS, event == "disable" or not accepted)
    resets = after.resets > before.resets
    holds("fault reset after a recovery alone", resets, bool(before.recovering[0]) or leaves)
    again = resets and before.resets and not leaves and not before.recovering[0]
    holds("recovery is one-shot", again, False)
    pressed = after.button.pressed
    stopped = after.state is S.FAULT and after.supervisor.status.action is Action.POWER_OFF
    holds("emergency stop dominates", pressed, stopped and not moving)
    holds("emergency stop is not left", pressed and event == "disable" and before.state is S.FAULT, not accepted)
    lost = before.state is S.FAULT is after.state
    first = before.supervisor.status.first_fault
    holds("the first fault is kept", lost, after.supervisor.status.first_fault == first)
    holds("an action is only made harder", lost, after.supervisor.status.action >= before.supervisor.status.action)
    since = after.supervisor.status.since >= before.supervisor.status.since
    holds("since only goes forward", True, since)


def run(drive: int, events: tuple[str, ...]) -> Checked:
    checked, resting, moving = Checked(Exploration()), set(), set()
    for item in explore(drive, events):
        if isinstance(item, Exploration):
            checked.result = item
            break
        check(*item, checked.seen)
        after = item[2]
        if any(after.demands):
            moving.add(after.key())
        elif rests(after):
            resting.add(after.key())
    places = {key: index for index, key in enumerate(checked.result.keys)}
    checked.resting, checked.moving = {places[key] for key in resting}, {places[key] for key in moving}
    return checked


def rests(world: World) -> bool:
    """DISABLED with every drive without power, nothing wrong and nothing to reset."""
    off = set(world.drives) == {mock_drive.SWITCH_ON_DISABLED}
    clear = not world.faulty and not world.pressed and not world.driver.needs_reset
    return world.state is S.DISABLED and off and clear


def judge(checked: Checked) -> None:
    """What holds of the whole graph: it moves at all, and nothing is a trap."""
    everything = set(range(len(checked.result.keys)))
    assert checked.moving and checked.resting
    stuck = everything - checked.result.can_reach(checked.resting, HARMLESS)
    assert not stuck, f"no way to rest by {sorted(HARMLESS)} from {checked.result.keys[min(stuck)]}"
    assert checked.result.can_reach(checked.moving) == everything, "a state from which the robot never moves again"
    rests = {source for source, event, target in checked.result.edges if event == "tick" and source == target}
    for key in (checked.result.keys[index] for index in rests):
        enabled = mock_drive.ENABLED in {key[6][0], *(drive for drive, *_ in key[7])}
        assert not (enabled and key[0][0] in (S.FAULT, S.DISABLED)), f"drives stay enabled: {key}"
        if key[0][0] in (S.ENABLED, S.PAUSED):
            assert {key[6][0], *(drive for drive, *_ in key[7])} == {mock_drive.ENABLED}, f"without its drives: {key}"
        (state, action, _), stopped = key[0], key[4][2]
        assert state is not S.FAULT or stopped >= action, f"the driver stops less hard than it was told to: {key}"


@pytest.fixture(scope="module")
def default() -> Checked:
    return run(0, DEFAULT)


def test_every_transition_keeps_the_invariants(default):
    judge(default)
    states, transitions = len(default.result.keys), len(default.result.edges)
    assert transitions == states * len(DEFAULT) and states > 300
    spoke = {"motion only ENABLED", "a fault brings standstill at once", "emergency stop dominates", "no re-enabling"}
    spoke |= {"FAULT is left by disable alone", "fault reset after a recovery alone", "the first fault is kept"}
    assert spoke <= set(default.seen) and "recovery is one-shot" not in default.seen


def test_every_operating_state_and_drive_state_was_reached(default):
    operating = {key[0][0] for key in default.result.keys}
    drives = {key[6][0] for key in default.result.keys}
    assert operating == set(S)
    assert {mock_drive.SWITCH_ON_DISABLED, mock_drive.ENABLED, mock_drive.QUICK_STOP, mock_drive.FAULT} <= drives


def test_lost_frames_change_no_invariant():
    """A drive's commands, its reports, the supervisor's heartbeat, the driver's report: each lost in any period."""
    checked = run(0, (*FEW, *LOSSY))
    judge(checked)
    assert "recovery is one-shot" not in checked.seen and checked.seen["fault reset after a recovery alone"] > 0


def counts(drive: int) -> tuple[int, int, int]:
    """Explore with one drive that differs; return how many states there are, move and rest."""
    checked = run(drive, FEW)
    judge(checked)
    return len(checked.result.keys), len(checked.moving), len(checked.resting)


@pytest.fixture(scope="module")
def first() -> tuple[int, int, int]:
    return counts(0)


ALIKE = [pytest.param(k, id=ACTUATORS[k], marks=[pytest.mark.slow] * (k in (1, 2))) for k in range(1, len(ACTUATORS))]
"""Drives 1 and 2 share the channel and the kind of drive 0."""


@pytest.mark.parametrize("drive", ALIKE)
def test_whichever_drive_differs_the_machine_is_the_same(drive, first):
    """One drive at a time faults; states, transitions and invariants do not depend on which, or on its channel."""
    assert counts(drive) == first


@pytest.mark.slow
@pytest.mark.parametrize("drive", (0, 3), ids=("delta_1", "roll"))
def test_every_event(drive):
    """The whole of it, with overruns, an error-passive bus and a lost power stage, on either channel."""
    checked = run(drive, EVENTS)
    judge(checked)
    assert len(checked.result.keys) > 1000
