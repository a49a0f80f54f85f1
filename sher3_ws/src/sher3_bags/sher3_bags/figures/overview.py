"""What a bag holds, without judging it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sher3_common import parse_json
from sher3_description import NAMESPACE, Robot, load_robot

from sher3_bags.case import read_case
from sher3_bags.figures.gaps import grid_periods
from sher3_bags.figures.report import table
from sher3_bags.figures.timing import topic_timing
from sher3_bags.provenance import PROVENANCE_RECORD
from sher3_bags.reading import read_run

FOR_OTHERS = ("/robot_description", "/joint_states", "/tf", f"{NAMESPACE}/markers", f"{NAMESPACE}/typed/")
"""Beginnings of the topics that follow from others and that viewers read, see `sher3_bags.recording.beside`."""
_LONG = ("versions", "parameters")


def overview(path: str | Path, namespace: str = NAMESPACE) -> dict[str, Any]:
    """Return topics with type, frame, count, rate, missing samples and pauses, and all metadata of a bag.

    Raises:
        BagError, TopicError, InvalidRobot: the bag does not read.
    """
    run = read_run(path, namespace=namespace, check=False)
    robot = Robot.from_yaml(run.robot_yaml) if run.robot_yaml else load_robot()
    periods = grid_periods(robot)
    topics = {
        topic: {
            "type": run[topic].type,
            "frame_id": run[topic].frame_id,
            "messages": timing.messages,
            "rate": timing.rate,
            "dropped": timing.dropped if topic in periods else None,
            "pauses": timing.pauses if topic in periods else None,
        }
        for topic, timing in topic_timing(run, robot).items()
    }
    return {
        "bag": str(path),
        "duration": (run.end - run.start) * 1e-9,
        "start": run.start,
        "topics": topics,
        "skipped": run.skipped,
        "run": run.metadata.to_record(),
        "provenance": {key: _plain(text) for key, text in run.records.get(PROVENANCE_RECORD, {}).items()},
        "records": {name: entries for name, entries in run.records.items() if name != PROVENANCE_RECORD},
        "robot_digest": robot.digest() if run.robot_yaml else None,
    }


def case_overview(path: Path) -> dict[str, Any]:
    """Return the runs of a case folder: excitation, repeat, amplitude, posture, loads, time and what is tracked.

    Raises:
        BagError: the case does not read.
    """
    case = read_case(path)
    runs = [
        {
            "bag": run.path.name if run.path else "",
            "excitation": run.metadata.excitation,
            "repeat": run.metadata.repeat,
            "amplitude": run.metadata.amplitude,
            "posture": run.metadata.posture,
            "loads": len(run.metadata.payload),
            "duration": (run.end - run.start) * 1e-9,
            "tracker": "tracker/measured_cp" in run,
            "origin": run.metadata.origin,
        }
        for run in case.runs
    ]
    return {"case": str(path), "robot_digest": case.robot.digest(), "runs": runs}


def case_text(data: dict[str, Any]) -> str:
    """Return the overview of a case as a table, a run to a line."""
    header = ("run", "excitation", "repeat", "amplitude", "posture", "loads", "seconds", "tracker", "origin")
    rows = [
        (*(run[key] for key in ("bag", "excitation", "repeat")), f"{run['amplitude']:g}", run["posture"] or "-",
         run["loads"] or "-", f"{run['duration']:.2f}", "yes" if run["tracker"] else "no", run["origin"])
        for run in data["runs"]
    ]  # fmt: skip
    return f"{data['case']}: a case of {len(rows)} runs\n\n{table(header, rows)}"


def _plain(text: str) -> Any:
    try:
        return parse_json(text) if text.startswith("{") else text
    except ValueError:
        return text


def overview_text(data: dict[str, Any]) -> str:
    """Return an overview as text; of a long provenance entry only the length is told."""
    rows = [
        (
            name,
            t["type"],
            t["frame_id"] or "-",
            t["messages"],
            f"{t['rate']:.1f}",
            *("-" if t[key] is None else t[key] for key in ("dropped", "pauses")),
        )
        for name, t in data["topics"].items()
    ]
    total = sum(t["messages"] for t in data["topics"].values())
    parts = [f"{data['bag']}: {data['duration']:.3f} s, {total} messages"]
    parts.append(table(("topic", "type", "frame", "messages", "Hz", "missing", "pauses"), rows))
    parts.append("run: " + ", ".join(f"{key} {value}" for key, value in data["run"].items() if value))
    origin = [f"{k}: {v if k not in _LONG else f'{len(v)} entries'}" for k, v in data["provenance"].items()]
    if origin:
        parts.append("\n".join(origin))
    beside = [topic for topic in data["skipped"] if topic.startswith(FOR_OTHERS)]
    if beside:
        parts.append("for viewers and other ROS tools: " + ", ".join(sorted(beside)))
    strange = {topic: why for topic, why in data["skipped"].items() if topic not in beside}
    if strange:
        parts.append("not read: " + ", ".join(f"{topic} ({why})" for topic, why in strange.items()))
    return "\n\n".join(parts)
