"""Draw the picture of the README: the robot under a scripted surgeon, and a gap that the diagnosis found.

    sher3 up --patient --record bags/star          # and, beside it: sher3 teleop tools/overview.yaml
    sher3 gap excite sweep,reversals --simulate --effects backlash.yaml -o case_001
    sher3 gap diagnose case_001
    python tools/overview_picture.py bags/star case_001 gap/case_001/verdict.json

Left, the robot as its kinematics place it, and the path of its tip, enlarged. Right, the signal chain with the stage of
the verdict lit, and one run of the case: what the load did less what the motor did, and what the cause predicts of it.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle, FancyBboxPatch
from sher3_bags import read_case, read_run
from sher3_common.files.text import read_json
from sher3_description import ACTUATORS, Robot, load_robot
from sher3_kinematics import RobotKinematics

ROOT = Path(__file__).resolve().parents[1]
INK, STEEL, PALE, LIT, SKY = "#22303c", "#7d8b97", "#dfe5ea", "#d9480f", "#1c7ed6"
STAGES = ("controller", "transport", "motor_mechanics", "transmission", "structure", "tip")
LABELS = ("controller", "transport", "motor", "transmission", "structure", "tip")
AZIMUTH, ELEVATION = np.radians(-62.0), np.radians(16.0)
"""From where the robot is seen."""


def seen(points: np.ndarray) -> np.ndarray:
    """Return points (n, 3) in mm as they are seen, (n, 2): a parallel projection."""
    x, y, z = np.atleast_2d(points).T * 1e3
    right = -np.sin(AZIMUTH) * x + np.cos(AZIMUTH) * y
    depth = np.cos(AZIMUTH) * x + np.sin(AZIMUTH) * y
    return np.stack([right, z * np.cos(ELEVATION) - depth * np.sin(ELEVATION)], axis=1)


def draw_line(axes: Axes, points: list, width: float, colour: str = INK, order: int = 3) -> None:
    """Draw a line through points in m."""
    axes.plot(*seen(np.array(points)).T, color=colour, lw=width, solid_capstyle="round", zorder=order)


def draw_robot(axes: Axes, robot: Robot) -> None:
    """Draw the robot at rest: rails, sliders, six links, platform, arm, tilt axis and tool."""
    delta, arm = robot.delta, robot.arm
    reach = np.sqrt(delta.base_radius**2 - delta.leg_width**2 / 4) - np.sqrt(
        delta.platform_radius**2 - delta.leg_width**2 / 4
    )
    height = np.sqrt(delta.link_length**2 - reach**2)
    balls, along, up = [], np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    for angle in sorted(delta.leg_azimuth, key=lambda a: -np.sin(a)):
        out = np.array([np.cos(angle), np.sin(angle), 0.0])
        side = np.array([-np.sin(angle), np.cos(angle), 0.0]) * delta.leg_width / 2
        base = out * np.sqrt(delta.base_radius**2 - delta.leg_width**2 / 4)
        top = out * np.sqrt(delta.platform_radius**2 - delta.leg_width**2 / 4) + up * height
        draw_line(axes, [base - up * 0.045, base + up * 0.045], 9.0, PALE, 1)
        draw_line(axes, [base - side, base + side], 11.0, STEEL, 2)
        for sign in (-1, 1):
            draw_line(axes, [base + sign * side, top + sign * side], 2.6, INK, 4)
            for ball in (base + sign * side, top + sign * side):
                axes.plot(*seen(ball).T, "o", ms=5, color="white", mec=INK, mew=1.2, zorder=5)
            balls.append((np.arctan2(*(top + sign * side)[1::-1]), top + sign * side))
    platform = seen(np.array([ball for _, ball in sorted(balls, key=lambda b: b[0])]))
    axes.fill(*platform.T, facecolor="#c3cdd6", edgecolor=INK, lw=1.2, zorder=3)
    centre = up * height
    shoulder = centre + up * arm.d1
    wrist = shoulder + along * arm.d2
    tilt = wrist + up * arm.d3
    draw_line(axes, [centre, shoulder], 11.0, STEEL, 5)
    draw_line(axes, [shoulder - along * 0.03, shoulder + along * 0.09], 15.0, STEEL, 5)
    draw_line(axes, [shoulder + along * 0.09, wrist], 8.0, STEEL, 5)
    draw_line(axes, [wrist, tilt], 7.0, STEEL, 5)
    draw_line(axes, [tilt, tilt + 0.45 * np.array(arm.tool)], 5.0, INK, 6)
    draw_line(axes, [tilt, tilt + np.array(arm.tool)], 1.8, INK, 6)
    # The axis of the verdict, and the hand on the tool.
    at = seen(tilt)[0]
    axes.plot(*at, "o", ms=17, color=LIT, alpha=0.25, zorder=6)
    axes.plot(*at, "o", ms=7, color=LIT, zorder=7)
    axes.text(at[0], at[1] + 10, "tilt", color=LIT, fontsize=11, ha="center", va="bottom")
    hand = seen(tilt + 0.4 * np.array(arm.tool))[0]
    arrow = {"arrowstyle": "-|>,head_length=0.6,head_width=0.35", "color": SKY, "lw": 2.6}
    axes.annotate("", hand + np.array([4, 0]), hand + np.array([38, 0]), arrowprops=arrow, zorder=7)
    axes.text(hand[0] + 40, hand[1], "hand", color=SKY, fontsize=11, ha="left", va="center")


def draw_path(axes: Axes, tip: np.ndarray, moving: np.ndarray, place: np.ndarray, radius: float) -> None:
    """Draw the path of the tip where the pedal is pressed, coloured by time and enlarged to a circle about `place`."""
    path = seen(tip)
    middle = (path.max(axis=0) + path.min(axis=0)) / 2
    scale = 0.72 * radius / np.abs(path - middle).max()
    shown = place + np.array([0, 0.08 * radius]) + (path - middle) * scale
    axes.add_patch(Circle(place, radius, facecolor="white", edgecolor=STEEL, lw=1.2, zorder=8))
    # Pieces of 20 ms, a little longer than that, so that no gaps show between them.
    pieces = [shown[i : i + 12] for i in np.flatnonzero(moving[:-12])[::10]]
    line = LineCollection(pieces, cmap="viridis", array=np.linspace(0, 1, len(pieces)), lw=2.4, zorder=9)
    axes.add_collection(line)
    axes.plot(*shown[-1], "o", ms=6, color=LIT, zorder=10)
    bar = place + np.array([-scale / 4, -0.82 * radius])
    axes.plot([bar[0], bar[0] + scale / 2], [bar[1]] * 2, color=INK, lw=2, zorder=9)
    axes.text(place[0], place[1] - 0.79 * radius, "0.5 mm", ha="center", va="bottom", fontsize=9, color=INK, zorder=9)


def draw_left(axes: Axes, robot: Robot, bag: Path) -> None:
    """Draw the robot and, enlarged, where its tip went."""
    run = read_run(bag)
    tip = run["measured_cp"].position
    pedal = np.interp(run["measured_cp"].stamp, run["pedal/measured"].stamp, run["pedal/measured"].axes[:, 0])
    draw_robot(axes, robot)
    rest = RobotKinematics(robot).transform_tip_to_base([0.0] * len(ACTUATORS))[:3, 3]
    at, place, radius = seen(rest)[0], np.array([205.0, -22.0]), 52.0
    edge = place - at
    for sign in (-1, 1):
        across = np.array([-edge[1], edge[0]]) / np.hypot(*edge) * radius * 0.97 * sign
        axes.plot(*np.array([at, place + across]).T, color=STEEL, lw=0.8, ls=(0, (4, 3)), zorder=7)
    axes.plot(*at, "o", ms=5, color=LIT, zorder=10)
    draw_path(axes, tip, pedal > 0.05, place, radius)
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_chain(axes: Axes, where: dict) -> None:
    """Draw the signal chain with the stage of the verdict lit."""
    axes.set(xlim=(0, 6.0), ylim=(0, 1))
    axes.set_axis_off()
    for i, (stage, label) in enumerate(zip(STAGES, LABELS, strict=True)):
        lit = stage == where["stage"]
        box = FancyBboxPatch(
            (i + 0.02, 0.42),
            0.88,
            0.34,
            boxstyle="round,pad=0,rounding_size=0.07",
            facecolor=LIT if lit else PALE,
            edgecolor="none",
            mutation_aspect=0.55,
        )
        axes.add_patch(box)
        axes.text(i + 0.46, 0.585, label, ha="center", va="center", fontsize=10.5, color="white" if lit else INK)
        if i:
            axes.annotate("", (i + 0.02, 0.59), (i - 0.11, 0.59), arrowprops={"arrowstyle": "-|>", "color": STEEL})
        if lit:
            times = where["gap"] / where["floor"]
            text = f"{where['actuator']}: {times:.0f} times what repeats differ by"
            axes.text(i + 0.46, 0.24, text, ha="center", va="center", fontsize=11, color=LIT)


def play(motor: np.ndarray, width: float, load: float) -> np.ndarray:
    """Return what follows `motor` with a play of `width` and begins at `load`."""
    follows = np.empty_like(motor)
    for i, at in enumerate(motor):
        load = min(max(load, at - width / 2), at + width / 2)
        follows[i] = load
    return follows


def draw_run(axes: Axes, case: Path, cause: dict) -> None:
    """Draw load less motor of the run with reversals, and what the play that was found makes of the motor's motion."""
    axis = ACTUATORS.index(cause["actuator"])
    run = next(r for r in read_case(case).runs if r.metadata.excitation.startswith("reversals"))
    time = (run["measured_js"].stamp - run["measured_js"].stamp[0]) * 1e-9
    motor, load = run["drives/measured_js"].position[:, axis], run["measured_js"].position[:, axis]
    width = cause["parameters"]["width"]
    axes.axhline(0.0, color=STEEL, lw=1.4, ls=(0, (1, 2)))
    axes.plot(time, (load - motor) * 1e6, color=SKY, lw=4.2, alpha=0.45, solid_capstyle="round")
    axes.plot(time, (play(motor, width["value"], load[0]) - motor) * 1e6, color=LIT, lw=1.4)
    end = time[-1] * 1.015
    axes.text(end, 31.0, "robot", color=SKY, fontsize=10.5, va="bottom")
    axes.text(end, 28.0, "cause found", color=LIT, fontsize=10.5, va="top")
    axes.text(end, 0.0, "nominal\nsimulator", color=STEEL, fontsize=10.5, va="center")
    axes.set_ylabel(f"load less motor, {cause['actuator']} [µm]", color=INK)
    axes.set_xlabel("time [s]", color=INK)
    axes.set(xlim=(0, time[-1]), ylim=(-42, 42), yticks=(-30, 0, 30))
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(colors=INK)


def sentence(verdict: dict) -> str:
    """Return the verdict's first cause in words."""
    cause = verdict["causes"][0]
    value, low, high = (1e6 * cause["parameters"]["width"][key] for key in ("value", "low", "high"))
    closed = 100 * verdict["closure"]["stage"]["value"]
    name = cause["effect"].replace("_", " ").capitalize()
    return (
        f"{name} on {cause['actuator']}, {value:.0f} µm ({low:.0f} … {high:.0f}); it closes {closed:.0f} % of the gap"
    )


def main() -> None:
    """Read the arguments and write the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bag", type=Path, help="recording with a moving tip")
    parser.add_argument("case", type=Path, help="case with a gap in one axis")
    parser.add_argument("verdict", type=Path, help="its verdict.json: backlash first")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "docs" / "static" / "overview.png")
    chosen = parser.parse_args()
    verdict = read_json(chosen.verdict)
    plt.rcParams.update({"font.family": "DejaVu Sans", "font.size": 10, "axes.edgecolor": STEEL})
    figure = plt.figure(figsize=(13, 5.4), dpi=120)
    title = {"fontsize": 15, "color": INK, "weight": "bold"}
    figure.text(0.03, 0.925, "A surgeon guides the robot", **title)
    figure.text(0.03, 0.875, "force in, slow motion out; the path of the tip enlarged", fontsize=11, color=STEEL)
    figure.text(0.44, 0.925, "Robot and simulator part: where, why and by how much", **title)
    figure.text(0.44, 0.875, sentence(verdict), fontsize=11, color=STEEL)
    draw_left(figure.add_axes((0.01, 0.02, 0.40, 0.83)), load_robot(), chosen.bag)
    draw_chain(figure.add_axes((0.43, 0.58, 0.56, 0.28)), verdict["where"][0])
    draw_run(figure.add_axes((0.48, 0.12, 0.42, 0.45)), chosen.case, verdict["causes"][0])
    figure.savefig(chosen.output, facecolor="white")


if __name__ == "__main__":
    main()
