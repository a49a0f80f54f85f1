"""What cannot be what it was taken for: stamps in milliseconds, columns in another order, torques given as places."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sher3_chain.manipulator.mjcf.drives import Drive, Driven

from sher3_public.errors import InputError
from sher3_public.records import Array, Arrays

SLOWEST = 0.5
"""Time between two samples, s, beyond which no motion of a joint is seen."""
BEYOND = 5.0
"""Scatter of the positions that a joint was told, over the scatter of its own position, beyond which they were torques:
a servo follows, and a torque has another unit."""
SETTLED = 0.5
"""Share of its scatter that a servo may keep in the second half of a record in which nothing was told."""
FOLLOWS = 0.98
"""Correlation of a motor's force with the place of its joint from which it is taken for the place itself."""
SAME = 2.0
"""Factor within which that force has the size of the position."""
APART = 0.9
"""Correlation of a servo's reference with its own joint below which the other joints are compared with it."""
UNITS = {"ms": 1e3, "us": 1e6, "ns": 1e9}
"""Other units of stamps, per s."""
TURNS, WIDER = 2.0, 2.0
"""Turns, and times a joint's range, beyond which angles are likely degrees."""


def stamps(time: Array) -> Array:
    """Return stamps (n,); raises InputError where they are too far apart for seconds."""
    apart = float(np.median(np.abs(np.diff(time)))) if len(time) > 1 else 0.0
    if apart > SLOWEST:
        unit, scale = next(((u, x) for u, x in UNITS.items() if apart / x < SLOWEST), ("ns", 1e9))
        remedy = f"give stamps in s: divide those in {unit} by {scale:.0f}, or units={{'time': '{unit}'}}"
        raise InputError("stamps are too far apart", value=f"{apart:.4g} s", limit=f"{SLOWEST:g} s", remedy=remedy)
    return time


def control_of(name: str, control: Array, position: Array, drive: Drive) -> None:
    """Check that a control (n,) can be what the model takes it for: a servo's position, or a motor's force.

    Raises:
        InputError: it cannot be that.
    """
    known = np.isfinite(control) & np.isfinite(position)
    if not known.any():
        remedy = "give what its actuator was told, or leave control out and give efforts"
        raise InputError(f"{name}: its control has no number", value="NaN or infinite alone", remedy=remedy)
    asked, q = drive.target(control[known]), position[known]
    wide, own = float(np.std(asked)), float(np.std(q))
    if not wide or not own:
        return
    if drive.servo and wide > BEYOND * own:
        remedy = "give it as effort=, or a model with motors"
        raise InputError(
            f"{name}: its control is no place that servo {drive.name} follows",
            value=f"scatter {wide:.3g}",
            limit=f"{BEYOND:g} times that of the position, {own:.3g}",
            remedy=remedy,
        )
    alike = float(np.corrcoef(asked, q)[0, 1])
    if not drive.servo and alike > FOLLOWS and 1.0 / SAME < wide / own < SAME:
        remedy = "give a model with position actuators, servo=(kp, kv), or effort="
        raise InputError(
            f"{name}: its control is the place of the joint, and motor {drive.name} takes a force",
            value=f"correlation {alike:.3f}",
            remedy=remedy,
        )


def infinite(runs: Sequence[Arrays]) -> list[str]:
    """Return a sentence on infinite controls (n, m), as of a controller that failed; none where all are finite."""
    given = [run.control for run in runs if run.control is not None]
    bad, of = sum(int(np.isinf(x).sum()) for x in given), sum(x.size for x in given)
    return [f"{bad} of {of} controls are infinite: no actuator was told that, so they are left out"] if bad else []


def held(names: Sequence[str], columns: Sequence[int | None], run: Arrays, drives: Mapping[str, Driven]) -> None:
    """Raise InputError where no control (n, m) ever changes and a servo goes on moving all the same."""
    if run.control is None or any(np.ptp(x[np.isfinite(x)]) for x in run.control.T if np.isfinite(x).any()):
        return
    for place, (name, column) in enumerate(zip(names, columns, strict=True)):
        drive = drives[name].drive if name in drives else None
        q = run.position[:, place]
        late, whole = float(np.nanstd(q[len(q) // 2 :])), float(np.nanstd(q))
        if drive is not None and drive.servo and column is not None and late > SETTLED * whole > 0.0:
            remedy = "give what the actuators were told, or leave control out and give efforts"
            raise InputError(f"{name}: moves while no control changes", value=f"{late:.3g}", remedy=remedy)


def places(names: Sequence[str], run: Arrays, reach: Mapping[str, float]) -> list[str]:
    """Return what to look at where angles (n, k) go further than joints do, one sentence each.

    Args:
        names: of the joints, one for each column of the positions.
        run: of which the positions are looked at.
        reach: largest angle of each joint that turns, rad; infinite where the model states none.

    Raises:
        InputError: a column has no number, or goes far beyond the model's range.
    """
    far = []
    for name, q in zip(names, run.position.T, strict=True):
        if not np.isfinite(q).any():
            raise InputError(f"{name}: position has no number", value="NaN alone", remedy="leave the joint out")
        most, own = float(np.nanmax(np.abs(q))), reach.get(name, np.inf)
        if name not in reach or most < TURNS * 2.0 * np.pi:
            continue
        if most > WIDER * own:
            value, remedy = f"{most:.4g} rad", "give angles in rad, or units={'position': 'deg'}"
            raise InputError(
                f"{name}: position leaves the model's range", value=value, limit=f"{own:.4g}", remedy=remedy
            )
        far.append(f"{name}: its position is in rad and reaches {most:.4g}; where these are degrees, np.radians(...)")
    return far


def columns_of_control(
    names: Sequence[str],
    columns: Sequence[int | None],
    run: Arrays,
    drives: Mapping[str, Driven],
    stated: bool,
    guesses: list[str],
) -> list[int | None]:
    """Return the column of `control` (n, m) of each joint, in the order of stated joints if servos follow that alone.

    Raises:
        InputError: a servo follows the control of another joint.
    """
    wrong = _other_follows(names, columns, run, drives)
    if wrong is None:
        return list(columns)
    order: list[int | None] = list(range(len(names)))
    fits = stated and run.control is not None and run.control.shape[1] == len(names)
    if fits and _other_follows(names, order, run, drives) is None:
        guesses.append("columns of control are in the order of `joints`: so the servos follow them")
        return order
    joint, other, own, found = wrong
    raise InputError(
        f"{joint}: its position follows the control of {other}",
        value=f"correlation {found:.3f}, {own:.3f} with its own",
        remedy="bring the columns of control and position into the model's order, or name them: joints=[...]",
    )


def _other_follows(
    names: Sequence[str], columns: Sequence[int | None], run: Arrays, drives: Mapping[str, Driven]
) -> tuple[str, str, float, float] | None:
    """Return a joint, the one whose control it follows in place of its own, and both correlations; or None."""
    asked: dict[str, Array] = {}
    for name, column in zip(names, columns, strict=True):
        drive = drives[name].drive if name in drives else None
        if run.control is not None and column is not None and drive is not None and drive.servo:
            asked[name] = drive.target(run.control[:, column])
    for name in asked:
        q = run.position[:, names.index(name)]
        alike = {other: _alike(x, q) for other, x in asked.items()}
        best = max(alike, key=lambda other: alike[other])
        if alike[name] < APART and alike[best] > FOLLOWS:
            return name, best, alike[name], alike[best]
    return None


def _alike(x: Array, y: Array) -> float:
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    return float(np.corrcoef(x, y)[0, 1]) if len(x) > 1 and np.ptp(x) and np.ptp(y) else 0.0
