"""Did the robot of a recorded session do what its script asked for? One sentence when it did not."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np
from sher3_common import parse_json
from sher3_common.operating_state import OperatingState, StateCommand
from sher3_common.reasons import TEXT, Reason
from sher3_runtime.clock import NEVER_NS

from sher3_bringup.errors import EndedInFault, SessionFailed
from sher3_bringup.surgeon.script import Script
from sher3_bringup.terminal.status_news import state_line

PRESSED = 0.5
"""Pedal travel, and force of the hand [N], from which the robot has to follow the hand in a step."""
SLIGHTEST = 1e-4
"""Tip travel [m] below which the tip did not move in a step: 0.1 mm, far above encoder noise."""
LONGEST_PAUSE = 1.0
"""Time [s] without a recorded pose from which a recording does not tell enough: steps last 0.6 to 4 s."""
INTENDED = frozenset({Reason.MOVING, Reason.PEDAL_RELEASED, Reason.NOT_ENABLED})


def judge(run: Any, script: Script, steps_begin: int) -> None:
    """Check a recorded session of a script against what the script asks for.

    Args:
        run: `sher3_bags.run.Run` with supervisor/status, admittance/status and measured_cp.
        script: that was played.
        steps_begin: stamp of the script's first tick [ns].

    Raises:
        EndedInFault: the robot went to FAULT.
        SessionFailed: it was never enabled, stopped by itself, was not recorded for some time, or did not move under
            the hand.
    """
    states = [parse_json(text) for text in run["supervisor/status"].data]
    for status in states:
        if status["first_fault"]:
            raise EndedInFault(f"{state_line(status)} ({_after(status['since'], steps_begin)})")
    if not any(step.command == StateCommand.ENABLE for step in script.steps):
        return
    enabled = [status for status in states if status["state"] == OperatingState.ENABLED]
    if not enabled:
        refused = [status["refused"]["text"] for status in states if status["refused"]]
        why = refused[-1] if refused else "no enable command arrived"
        raise SessionFailed(
            f"the robot was never enabled: {why}", remedy="start again; see supervisor/status in the bag"
        )
    _look_for_stops(run, states, steps_begin)
    _look_for_pauses(run)
    _look_for_motion(run, script, steps_begin)


def _look_for_stops(run: Any, states: list[dict[str, Any]], begin: int) -> None:
    """Raise SessionFailed when the law itself stopped the robot while it was enabled."""
    spans = list(_enabled_spans(states))
    for text in run["admittance/status"].data:
        status = parse_json(text)
        reason, since = Reason[status["reason"]], int(status["since"])
        if reason not in INTENDED and any(start < since < end for start, end in spans):
            remedy = "see admittance/status in the bag; a machine less busy helps where samples came too late"
            raise SessionFailed(f"the robot stopped by itself {_after(since, begin)}: {TEXT[reason]}", remedy=remedy)


def _enabled_spans(states: list[dict[str, Any]]) -> Iterator[tuple[int, int]]:
    for status, following in pairwise([*states, {"since": NEVER_NS}]):
        if status["state"] == OperatingState.ENABLED:
            yield int(status["since"]), int(following["since"])


def _look_for_pauses(run: Any) -> None:
    """Raise SessionFailed when the poses of the tip, which the robot always sends, were not recorded for some time."""
    stamp = run["measured_cp"].stamp
    longest = float(np.diff(stamp).max(initial=0)) * 1e-9
    if longest > LONGEST_PAUSE:
        raise SessionFailed(
            "the recording has a hole",
            value=f"{longest:.1f} s without a pose of the tip",
            limit=f"at most {LONGEST_PAUSE:g} s",
            remedy="this computer has too much else to do: start the demo again when it has less",
        )


def _look_for_motion(run: Any, script: Script, begin: int) -> None:
    """Raise SessionFailed when the tip did not move in a step with pressed pedal and a hand beyond the dead band."""
    stamp, position = run["measured_cp"].stamp, run["measured_cp"].position
    time = 0.0
    for step in script.steps:
        start, time = time, time + step.duration
        pushed = max(map(abs, (*step.wrench[:3], *step.dither[:3]))) >= PRESSED
        if step.pedal < PRESSED or not pushed:
            continue
        rows = (stamp >= begin + round(start * 1e9)) & (stamp < begin + round(time * 1e9))
        travel = float(np.linalg.norm(np.ptp(position[rows], axis=0))) if rows.any() else 0.0
        if travel < SLIGHTEST:
            raise SessionFailed(
                f"the tip did not move in step {step.name}",
                value=f"{travel * 1e3:.3f} mm",
                limit=f"at least {SLIGHTEST * 1e3:g} mm",
                remedy="see admittance/status and motion/status in the bag",
            )


def _after(stamp: int, begin: int) -> str:
    return f"{(stamp - begin) * 1e-9:.1f} s after the start"
