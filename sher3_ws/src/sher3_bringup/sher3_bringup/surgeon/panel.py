"""What the robot answers to the surgeon at the keyboard, as lines of text; plain data, no terminal."""

from __future__ import annotations

import math

import numpy as np
from sher3_view.live.snapshot import STALE, Snapshot, fault_text

NOBODY = "no robot is heard: start one with `sher3 up`, or name its --domain"


def panel_lines(snapshot: Snapshot, hand: str, answer: str, now: int, width: int = 100) -> list[str]:
    """Return the lines of the panel, always the same number and none wider than the terminal.

    Args:
        snapshot: what was heard of the robot.
        hand: what the surgeon's hand and foot do.
        answer: to the last request that has one, such as a tare.
        now: time [ns].
        width: of the terminal.
    """
    refusals = snapshot.refusals()
    lines = [
        f"state   {_state(snapshot, now)}",
        f"tip     {_tip(snapshot)}",
        f"robot   {_felt(snapshot)}",
        f"hand    {hand}",
        f"answer  {answer or '-'}",
        f"refused {' | '.join(refusals) or '-'}",
    ]
    return [line[: width - 1] for line in lines]


def _state(snapshot: Snapshot, now: int) -> str:
    joints, status = snapshot.samples.get("measured_js"), snapshot.status("supervisor/status")
    if joints is None and not status:
        return NOBODY
    state = str(status.get("state", "unknown"))
    why = snapshot.status("admittance/status").get("text") if state == "ENABLED" else f"since {status.get('reason')}"
    fault = status.get("first_fault") or {}
    if fault:
        why = fault_text(fault)
    age = math.inf if joints is None else (now - joints.stamp) * 1e-9
    return f"{state}: {why}" + (f"; the joints are {age:.1f} s old" if age > STALE else "")


def _tip(snapshot: Snapshot) -> str:
    pose = snapshot.samples.get("measured_cp")
    if pose is None:
        return "-"
    x, y, z = (1e3 * value for value in pose.position)
    cap = "no cap" if math.isinf(snapshot.cap) else f"cap {snapshot.cap * 1e3:g}"
    return f"{x:+9.3f} {y:+9.3f} {z:+9.3f} mm   {snapshot.speed * 1e3:.2f} mm/s, {cap}"


def _felt(snapshot: Snapshot) -> str:
    settings = snapshot.status("motion/settings")
    centre = snapshot.remote_centre
    where = "none" if centre is None else " ".join(f"{1e3 * value:+.1f}" for value in centre) + " mm"
    force = float(np.linalg.norm(snapshot.force))
    regime = settings.get("regime", "-")
    return f"force {force:.2f} N   pedal {snapshot.pedal:.0%}   regime {regime}   remote centre {where}"
