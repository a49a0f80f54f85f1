"""A film as one HTML file that opens without network: style, script and data are inside it."""

from __future__ import annotations

import base64
import html
import json
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sher3_view.errors import ViewError
from sher3_view.film import Film
from sher3_view.ghost import Ghost
from sher3_view.scene import METRES_PER_NEWTON, Primitive

FILES = Path(__file__).with_name("static")
SCRIPTS = ("vectors.js", "stage.js", "overlay.js", "plots.js", "view.js")
ABSENT = -32768
"""A coordinate of a part that is not there, among the 16-bit numbers."""
STEPS = 32767


def write_page(film: Film, path: str | Path, ghosts: Sequence[Ghost] = (), figures: str = "") -> Path:
    """Write the page of a film; return its path.

    Args:
        film: to show.
        path: of the file.
        ghosts: other robots, drawn transparent beside the first; their exaggeration is stated on the page.
        figures: a further section, as HTML.

    Raises:
        ViewError: the file cannot be written.
    """
    target = Path(path)
    try:
        target.write_text(page(film, ghosts, figures), encoding="utf-8")
    except OSError as error:
        raise ViewError(f"{target} cannot be written ({error.strerror})", remedy="name a writable file") from error
    return target


def page(film: Film, ghosts: Sequence[Ghost] = (), figures: str = "") -> str:
    """Return the text of the page; see `write_page`."""
    script = "\n".join((FILES / name).read_text(encoding="utf-8") for name in SCRIPTS)
    data = json.dumps(_data(film, ghosts), separators=(",", ":"), allow_nan=False)
    parts = {
        "@TITLE@": html.escape(film.name),
        "@STYLE@": (FILES / "view.css").read_text(encoding="utf-8"),
        "@SCRIPT@": script,
        # A name in the recording may hold any text; "</script>" inside it must not end the data.
        "@FIGURES@": figures,
        "@DATA@": data.replace("<", "\\u003c"),
    }
    text = (FILES / "view.html").read_text(encoding="utf-8")
    return re.sub("|".join(parts), lambda mark: parts[mark.group()], text)


def _data(film: Film, ghosts: Sequence[Ghost]) -> dict[str, Any]:
    points = np.concatenate([film.points, *(ghost.points for ghost in ghosts)])
    packed, origin, step = _packed(points)
    count = len(film.seconds)
    return {
        "name": film.name,
        "seconds": _rounded(film.seconds, 4),
        "fixed": [_described(part, part.points) for part in film.fixed],
        "moving": [_described(part) for part in film.moving],
        "origin": origin,
        "step": step,
        "points": _text(packed[:count]),
        "ghosts": [
            {
                "name": ghost.name,
                "points": _text(packed[k * count : (k + 1) * count]),
                "exaggeration": ghost.exaggeration,
                "distance": _rounded(ghost.distance, 9),
            }
            for k, ghost in enumerate(ghosts, 1)
        ],
        "tip": _rounded(film.tip, 7),
        "position": _rounded(film.position, 7),
        "force": _rounded(film.force, 4),
        "speed": _rounded(film.speed, 7),
        "cap": _rounded(film.cap, 6),
        "tracked": film.tracked,
        "tracking": _rounded(film.tracking, 9),
        "pedal": _rounded(film.pedal, 3),
        "edge": _rounded(film.edge, 5),
        "states": film.states,
        "motion": film.motion,
        "limits": film.limits,
        "dropped": film.dropped,
        "metresPerNewton": METRES_PER_NEWTON,
        "absent": ABSENT,
    }


def _described(part: Primitive, points: NDArray[np.float64] | None = None) -> dict[str, Any]:
    described = {"name": part.name, "kind": part.kind, "role": part.role, "size": part.size, "count": len(part.points)}
    return described if points is None else {**described, "points": np.round(points, 6).tolist()}


def _packed(points: NDArray[np.float64]) -> tuple[NDArray[np.int16], list[float], float]:
    """Return points as 16-bit numbers, with the origin (3,) and the step [m] that turn them back.

    The robot is 0.4 m long, so a step is about 6 µm: less than a pixel of the whole robot. The tip's path, which is
    looked at from near, is sent in full beside them.
    """
    flat = points.reshape(-1, 3)
    low, high = np.nanmin(flat, axis=0), np.nanmax(flat, axis=0)
    origin, step = 0.5 * (low + high), max(float((high - low).max()), 1e-6) / (2 * STEPS)
    steps = np.round((points - origin) / step)
    return np.where(np.isnan(steps), ABSENT, steps).astype("<i2"), origin.tolist(), step


def _text(array: NDArray[np.int16]) -> str:
    return base64.b64encode(array.tobytes()).decode("ascii")


def _rounded(values: NDArray[np.float64], digits: int) -> list[Any]:
    """Return nested lists of rounded numbers, None for what is not finite."""
    if values.ndim == 2:
        return [_rounded(row, digits) for row in values]
    return [round(value, digits) if math.isfinite(value) else None for value in values.tolist()]
