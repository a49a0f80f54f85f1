"""The figures of a bench-top evaluation by name, from the pictures of its tests.

Names of figures the paper prints are those of `sher3 paper --only benchtop`. All lengths in um, forces in N.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from sher3_paper.tables import printed

from sher3_benchtop.cameras.camera import Camera, Reading, View, view
from sher3_benchtop.cameras.pictures import Shots
from sher3_benchtop.evaluation.measures import iso9283, motion_errors, repeatability, slope
from sher3_benchtop.protocol.plan import ACCURACY, PLANES, REPEATABILITY, RESOLUTION, Grid

Floats = NDArray[np.float64]
Figures = dict[str, float]
Tests = Mapping[str, Mapping[str, Shots]]
"""Pictures by test and group."""
CAMERAS = 64
"""Random cameras; the figure is the median over them."""


def evaluate(tests: Tests, reading: Reading, cameras: int = CAMERAS) -> Figures:
    """Return every figure that the given tests allow: the median over random cameras.

    Args:
        tests: pictures by test and group; missing tests are left out.
        reading: of the cameras' printed error.
        cameras: how many to draw.
    """
    count = 1 if reading == "tip" else cameras
    draws = [_once(tests, reading, seed) for seed in range(count)]
    return {name: float(np.median([draw[name] for draw in draws])) for name in draws[0]}


def _once(tests: Tests, reading: Reading, seed: int) -> Figures:
    found: Figures = {}
    for name, measure in MEASURES.items():
        if name in tests:
            wide = name in ("grid_10mm", "deflection")
            found |= measure(tests[name], Cameras(view("10mm" if wide else "2mm"), reading, seed))
    return found


class Cameras:
    """The two cameras, one per plane."""

    def __init__(self, view: View, reading: Reading, seed: int) -> None:
        self._cameras = {plane: Camera(view, reading, 2 * seed + k) for k, plane in enumerate(PLANES)}

    def read(self, plane: str, places: Floats) -> Floats:
        """Return what the camera of a plane reads (n, 2) [m] of places (n, 2) [m]."""
        return self._cameras[plane].read(places)


def _read_grid(shots: Mapping[str, Shots], cameras: Cameras) -> dict[str, Floats]:
    return {plane: cameras.read(plane, shots[plane].plane(plane)) for plane in PLANES}


def accuracy(shots: Mapping[str, Shots], cameras: Cameras) -> Figures:
    """Return the accuracy table: error along each axis for motions along each, mean and standard deviation."""
    places, spacing = _read_grid(shots, cameras), ACCURACY.spacing
    errors: dict[tuple[str, str], list[Floats]] = {}
    for plane in PLANES:
        for k, motion in enumerate(plane):
            found = motion_errors(places[plane], ACCURACY.points[shots[plane].target], k, spacing)
            for row, axis in enumerate(plane):
                errors.setdefault((motion, axis), []).append(found[:, row])
    figures: Figures = {}
    for (motion, axis), parts in errors.items():
        values = 1e6 * np.concatenate(parts)
        figures[f"accuracy/{motion}_motion/{axis}/mean"] = values.mean()
        figures[f"accuracy/{motion}_motion/{axis}/std"] = values.std(ddof=1)
    worst = max(iso9283_alone(places[p], shots[p], ACCURACY).max() for p in PLANES)
    return figures | {"iso9283/grid_10mm/pose_accuracy/worst": 1e6 * float(worst)}


def iso9283_alone(places: Floats, shots: Shots, grid: Grid) -> Floats:
    """Return the pose accuracy of a grid whose points are visited once."""
    wanted = grid.points[shots.target]
    return np.linalg.norm(places - places.mean(axis=0) - (wanted - wanted.mean(axis=0)), axis=1)


def _repeated(name: str, grid: Grid) -> Callable[[Mapping[str, Shots], Cameras], Figures]:
    def measure(shots: Mapping[str, Shots], cameras: Cameras) -> Figures:
        places = _read_grid(shots, cameras)
        spread = {plane: 1e6 * repeatability(places[plane], shots[plane].target) for plane in PLANES}
        vertical = 0.5 * (spread["xz"][1] + spread["yz"][1])
        figures = dict(zip("xyz", (spread["xz"][0], spread["yz"][0], vertical), strict=True))
        standard = {p: iso9283(places[p], shots[p].target, grid.points) for p in PLANES}
        poses = {f"repeatability/{name}/{axis}": float(value) for axis, value in figures.items()}
        for plane in PLANES:
            poses[f"iso9283/{name}/{plane}/pose_accuracy/worst"] = 1e6 * float(standard[plane].accuracy.max())
            poses[f"iso9283/{name}/{plane}/pose_repeatability/worst"] = 1e6 * float(standard[plane].repeatability.max())
        return poses

    return measure


def resolution(shots: Mapping[str, Shots], cameras: Cameras) -> Figures:
    """Return the figures of the smallest grid, and its mean step, which tells whether 10 um are made."""
    figures = _repeated("grid_10um", RESOLUTION)(shots, cameras)
    for plane in PLANES:
        places, target = cameras.read(plane, shots[plane].plane(plane)), shots[plane].target
        centres = np.array([places[target == k].mean(axis=0) for k in range(4)])
        wanted = RESOLUTION.points
        for k, axis in enumerate(plane):
            high = wanted[:, k] > 0.0
            figures[f"resolution/{plane}/{axis}_step"] = 1e6 * float(centres[high, k].mean() - centres[~high, k].mean())
    return figures


def rotation(shots: Mapping[str, Shots], cameras: Cameras) -> Figures:
    """Return size and repeatability of the tip's motion when roll or tilt turn by 0.02 degrees.

    A roll moves the tip along y and a tilt along x: the roll is read in yz, the tilt in xz. (The paper's text says xy
    and yz, its caption xz and xy, and it had no camera on xy.)
    """
    figures: Figures = {}
    for axis, plane in (("roll", "yz"), ("tilt", "xz")):
        places, target = cameras.read(plane, shots[axis].plane(plane)), shots[axis].target
        ends = [places[target == k, 0] for k in (0, 1)]
        figures[f"rotation/{axis}/step"] = 1e6 * abs(float(ends[1].mean() - ends[0].mean()))
        figures[f"rotation/{axis}/repeatability"] = 1e6 * float(np.mean([end.std(ddof=1) for end in ends]))
    return figures


def deflection(shots: Mapping[str, Shots], cameras: Cameras) -> Figures:
    """Return the compliance table, the means, and the largest motion of the tip under load [um/N]."""
    places = printed()["deflection_table"]["positions"]
    figures: Figures = {}
    for axis in "xyz":
        slopes = []
        for number, (x, y) in enumerate(places):
            group = shots[f"{axis}{number}"]
            slopes.append(1e6 * slope(group.force, _along(axis, group.grasp, cameras)))
            figures[f"compliance/{axis}/({x}, {y})"] = slopes[-1]
        figures[f"compliance/{axis}/mean"] = float(np.mean(slopes))
        tips = [1e6 * slope(shots[f"{axis}{n}"].force, shots[f"{axis}{n}"].tip[:, "xyz".index(axis)]) for n in range(5)]
        figures[f"compliance/{axis}/tip_mean"] = float(np.mean(tips))
    return figures


def _along(axis: str, points: Floats, cameras: Cameras) -> Floats:
    """Return what the cameras read (n,) of points (n, 3) [m] along an axis; z is the mean of both."""
    planes = [plane for plane in PLANES if axis in plane]
    seen = [cameras.read(p, (points - points[0])[:, list(PLANES[p])])[:, p.index(axis)] for p in planes]
    return np.mean(seen, axis=0)


MEASURES: dict[str, Callable[[Mapping[str, Shots], Cameras], Figures]] = {
    "grid_10mm": accuracy,
    "grid_2mm": _repeated("grid_2mm", REPEATABILITY),
    "grid_10um": resolution,
    "rotation": rotation,
    "deflection": deflection,
}
