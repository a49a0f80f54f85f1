"""Commands `fk` and `ik`: forward and inverse kinematics on the command line."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from sher3_common import Sher3Error
from sher3_common.commands.options import Json, reported

if TYPE_CHECKING:
    import numpy as np

    from sher3_kinematics.robot_kinematics import RobotKinematics

app = typer.Typer(no_args_is_help=True, help="Forward and inverse kinematics.")

UNITS = ("m", "m", "m", "rad", "m")
ANY_NUMBER = {"ignore_unknown_options": True}
"""Lets negative numbers through, which would otherwise be read as options."""

RobotOption = Annotated[Path | None, typer.Option("--robot", help="Robot file; the nominal robot if not given.")]
HumanOption = Annotated[bool, typer.Option("--mm-deg", help="Read and print mm and degrees instead of m and rad.")]


@app.command(context_settings=ANY_NUMBER)
def fk(
    q: Annotated[list[float], typer.Argument(metavar="Q...", help="delta_1 delta_2 delta_3 roll tilt [m m m rad m]")],
    robot: RobotOption = None,
    as_json: Json = False,
    mm_deg: HumanOption = False,
) -> None:
    """Print the tip pose in {b} for five actuator positions; tilt is the slider's travel, not the angle.

    Examples:
        sher3 fk 0 0 0 0 0

        sher3 fk -- 0.004 -0.003 0.001 -0.2 0.005

        sher3 fk --mm-deg 4 -3 1 -10 5 --json
    """
    import numpy as np
    from sher3_description import load_robot

    from sher3_kinematics.robot_kinematics import RobotKinematics

    with reported(as_json):
        _expect(len(q), 5, "positions", "delta_1 delta_2 delta_3 roll tilt")
        kinematics = RobotKinematics(load_robot(robot))
        positions = np.array(q) * (_scale(mm_deg) if mm_deg else 1.0)
        kinematics.require_within_limits(positions)
        _print_pose(kinematics, positions, as_json, mm_deg)


@app.command(context_settings=ANY_NUMBER)
def ik(
    pose: Annotated[
        list[float],
        typer.Argument(
            metavar="POSE...", help="X Y Z [m] of the tip, then AX AY AZ in which the needle points, in {b}"
        ),
    ],
    robot: RobotOption = None,
    as_json: Json = False,
    mm_deg: HumanOption = False,
) -> None:
    """Print the actuator positions for a tip position and a tool direction; without a direction, straight down.

    Examples:
        sher3 ik 0.2 0 0.097

        sher3 ik -- 0.2 0.005 0.1 0.1 -0.2 -1

        sher3 ik --mm-deg 200 5 100 0.1 -0.2 -1 --json
    """
    import numpy as np
    from sher3_description import load_robot

    from sher3_kinematics.robot_kinematics import RobotKinematics

    with reported(as_json):
        if len(pose) == 3:
            pose = [*pose, 0.0, 0.0, -1.0]
        _expect(len(pose), 6, "numbers", "X Y Z or X Y Z AX AY AZ")
        kinematics = RobotKinematics(load_robot(robot))
        position = np.array(pose[:3]) * (1e-3 if mm_deg else 1.0)
        q = kinematics.inverse(position, pose[3:])
        _print_actuators(kinematics, q, as_json, mm_deg)


def _expect(count: int, needed: int, what: str, order: str) -> None:
    if count != needed:
        raise Sher3Error(f"wrong number of {what}", value=count, limit=needed, remedy=f"give {order}")


def _scale(mm_deg: bool) -> np.ndarray:
    import numpy as np

    return np.array([1e-3, 1e-3, 1e-3, math.pi / 180, 1e-3]) if mm_deg else np.ones(5)


def _print_pose(kinematics: RobotKinematics, q: np.ndarray, as_json: bool, mm_deg: bool) -> None:
    import numpy as np

    from sher3_kinematics.kernel.batch import tip_quaternion_batch

    transform = kinematics.transform_tip_to_base(q)
    rotation = np.ascontiguousarray(transform[:3, :3])
    tilt, singularity = kinematics.tilt_linkage.angle(float(q[4])), kinematics.singularity_distance(q)
    edge = kinematics.delta.edge_distance(kinematics.delta.forward(q[:3]))
    if as_json:
        result = {
            "position": transform[:3, 3].tolist(),
            "orientation_xyzw": tip_quaternion_batch(rotation[None])[0].tolist(),
            "axis": (-rotation[:, 2]).tolist(),
            "roll_angle": float(q[3]),
            "tilt_angle": tilt,
            "workspace_edge_distance": edge,
            "singularity": singularity._asdict(),
            "units": "m, rad",
        }
        typer.echo(json.dumps(result, indent=2))
        return
    length, unit, turn, angle = (1e3, "mm", 180 / math.pi, "deg") if mm_deg else (1.0, "m", 1.0, "rad")
    typer.echo(f"tip position [{unit}]       " + _row(transform[:3, 3] * length))
    typer.echo("tool axis              " + _row(-rotation[:, 2]))
    typer.echo(f"roll, tilt angle [{angle}] " + _row([q[3] * turn, tilt * turn]))
    typer.echo(f"workspace edge [{unit}]     " + _row([edge * length]))
    typer.echo(f"singularity distance   {singularity.distance:.4f} ({singularity.part})")


def _print_actuators(kinematics: RobotKinematics, q: np.ndarray, as_json: bool, mm_deg: bool) -> None:
    from sher3_description import ACTUATORS

    if as_json:
        result = {"q": dict(zip(ACTUATORS, q.tolist(), strict=True)), "units": dict(zip(ACTUATORS, UNITS, strict=True))}
        result["tilt_angle"] = kinematics.tilt_linkage.angle(float(q[4]))  # type: ignore[assignment]
        typer.echo(json.dumps(result, indent=2))
        return
    for name, unit, value, scale in zip(ACTUATORS, UNITS, q, _scale(mm_deg), strict=True):
        shown = {"m": "mm", "rad": "deg"}[unit] if mm_deg else unit
        typer.echo(f"{name:8s} {value / scale:14.9g} {shown}")


def _row(values: np.ndarray | list[float]) -> str:
    return " ".join(f"{value:14.9g}" for value in values)


if __name__ == "__main__":
    app()
