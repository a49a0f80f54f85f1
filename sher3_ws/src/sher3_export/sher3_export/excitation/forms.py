"""An excitation as a file: set-points as CSV, a trajectory of ROS 2, keyframes of controls for MuJoCo."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from sher3_common import dump_yaml

from sher3_export.errors import ExportError
from sher3_export.excitation.design import Excitation
from sher3_export.xml_file import write_xml

COLUMNS = (("position", ""), ("velocity", "/s"), ("acceleration", "/s^2"))
"""What is written of a joint, and what follows its unit."""
NANO = 1_000_000_000
"""Nanoseconds in a second."""


def as_csv(made: Excitation) -> str:
    """Return time, and position, velocity and acceleration of every joint, with units in the header."""
    header, columns = ["time [s]"], [made.time]
    for i, (joint, slides) in enumerate(zip(made.joints, made.slides, strict=True)):
        unit = "m" if slides else "rad"
        for (name, per), x in zip(COLUMNS, made.motion.motion(made.time), strict=True):
            header.append(f"{joint}_{name} [{unit}{per}]")
            columns.append(x[:, i])
    rows = [",".join(f"{x:.9g}" for x in row) for row in np.column_stack(columns)]
    return "\n".join([",".join(header), *rows, ""])


def as_trajectory(made: Excitation) -> str:
    """Return a `trajectory_msgs/msg/JointTrajectory` as YAML, as `ros2 topic pub` takes it."""
    q, v, a = made.motion.motion(made.time)
    points = []
    for k, t in enumerate(made.time):
        whole, rest = divmod(round(float(t) * NANO), NANO)
        moved = {"positions": q[k], "velocities": v[k], "accelerations": a[k]}
        point = {name: [float(f"{y:.9g}") for y in x] for name, x in moved.items()}
        points.append({**point, "time_from_start": {"sec": whole, "nanosec": rest}})
    return dump_yaml({"joint_names": list(made.joints), "points": points})


def as_mjcf(made: Excitation) -> str:
    """Return an MJCF file of keyframes to include: the controls of one position actuator for each joint, in order."""
    root = Element("mujoco", {"model": "excitation"})
    frames = SubElement(root, "keyframe")
    for t, q in zip(made.time, made.motion.motion(made.time)[0], strict=True):
        SubElement(frames, "key", {"time": f"{t:.9g}", "ctrl": " ".join(f"{x:.9g}" for x in q)})
    return write_xml(root, [f"controls of position actuators on {', '.join(made.joints)}, in this order"])


FORMS: Mapping[str, Callable[[Excitation], str]] = {".csv": as_csv, ".yaml": as_trajectory, ".xml": as_mjcf}
"""Ending of a file -> its form."""


def save(path: Path, made: Excitation) -> None:
    """Write an excitation in the form that the ending names; raises ExportError for another ending."""
    form = FORMS.get(path.suffix)
    if form is None:
        remedy = "csv: set-points; yaml: a trajectory of ROS 2; xml: controls of MJCF"
        raise ExportError(f"{path}: no such form", value=path.suffix, limit=", ".join(FORMS), remedy=remedy)
    try:
        path.write_text(form(made), encoding="utf-8")
    except OSError as error:
        raise ExportError(f"{path}: cannot be written", value=error.strerror, remedy="choose another file") from error
