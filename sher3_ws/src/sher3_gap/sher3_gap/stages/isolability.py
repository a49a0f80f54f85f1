"""Structural isolability: which effects the recorded topics can tell apart, computed before anything is fitted.

One DAE of the signal chain with one fault per effect, analysed by its Dulmage-Mendelsohn decomposition (see
`overdetermined`). Effects in one group show in the same equations: only the *shape* of their signature (over speed,
position, load, time) can tell them apart, never the place where they show.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.reporter import Isolability
from sher3_effects import library

from sher3_gap.stages.overdetermined import Mask, not_isolable, overdetermined

PAYLOAD = "payload"
"""Stands for known tip loads among the topics: the contract records them, a surgeon's hand does not."""


class Equation(NamedTuple):
    """One equation: its unknowns, the effects that break it, and the topic it needs when it is a reading."""

    unknowns: tuple[str, ...]
    effects: tuple[str, ...] = ()
    topic: str = ""


def _breaking(*relations: str) -> tuple[str, ...]:
    """Return the effects that break one of the relations: the one their page names, or the one of their stage."""
    return tuple(i for i, page in library().items() if (page.breaks or page.stage) in relations)


def _chain() -> list[Equation]:
    """Return the chain of one axis from set-point to tip; the tip twice, because loads come and go within a run."""
    return [
        Equation(("reference",), (), "setpoint_js"),
        Equation(("command", "reference", "load_reading"), _breaking("controller")),
        Equation(("demand", "command"), _breaking("transport")),
        Equation(("force", "demand", "speed"), _breaking("drive")),
        Equation(("force", "speed", "motor", "load", "wrench"), _breaking("motor_mechanics")),
        Equation(("speed", "motor")),
        Equation(("load", "motor", "force"), _breaking("transmission")),
        Equation(("free_tip", "load"), _breaking("mechanism")),
        Equation(("loaded_tip", "load", "wrench"), _breaking("mechanism", "structure")),
        Equation(("command",), (), "servo_jv"),
        Equation(("demand",), (), "drives/setpoint_jv"),
        Equation(("force",), (), "drives/measured_js"),
        Equation(("motor",), _breaking("both_encoders"), "drives/measured_js"),
        Equation(("load_reading", "load"), _breaking("load_encoder", "both_encoders")),
        Equation(("load_reading",), (), "measured_js"),
        Equation(("wrench_reading", "wrench", "load"), _breaking("force_sensor")),
        Equation(("wrench_reading",), (), "force/measured_cf"),
        Equation(("wrench",), (), PAYLOAD),
        Equation(("free_tip",), (), "tracker/measured_cp"),
        Equation(("loaded_tip",), (), "tracker/measured_cp"),
    ]


def _incidence(equations: Iterable[Equation], columns: list[str], field: str) -> Mask:
    rows = [[name in getattr(e, field) for name in columns] for e in equations]
    return np.array(rows, dtype=bool).reshape(len(rows), len(columns))


@lru_cache(maxsize=64)
def _analyse(equations: tuple[Equation, ...]) -> Isolability:
    topics = {e.topic for e in equations if e.topic}
    unknowns = sorted({u for e in equations for u in e.unknowns})
    effects = sorted({f for e in equations for f in e.effects})
    x, f = _incidence(equations, unknowns, "unknowns"), _incidence(equations, effects, "effects")
    visible = f[overdetermined(x)].any(axis=0)
    confused = not_isolable(x, f)
    alike = confused & confused.T
    groups = {frozenset(effects[j] for j in np.flatnonzero(alike[i] & visible)) for i in np.flatnonzero(visible)}
    hidden = frozenset(e for e, seen in zip(effects, visible, strict=True) if not seen)
    ordered = tuple(sorted(groups, key=lambda g: (-len(g), sorted(g))))
    return Isolability(tuple(sorted(topics - {PAYLOAD})), ordered, hidden)


def structure(topics: Collection[str], known_load: bool = True) -> Isolability:
    """Analyse which effects the recorded topics can tell apart.

    Args:
        topics: names relative to `/sher3`; those that no equation uses are ignored.
        known_load: whether the load on the tip is known, as in scripted runs.
    """
    known = {*topics, PAYLOAD} if known_load else set(topics)
    return _analyse(tuple(e for e in _chain() if not e.topic or e.topic in known))
