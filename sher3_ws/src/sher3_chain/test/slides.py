"""Axes simulated for the tests, with an integrator of their own."""

from collections.abc import Sequence

import numpy as np
from sher3_chain.axes.machine import Axes
from sher3_chain.joint.description import AxesDescription, Axis
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose

PERIOD, MASS, KP, KD, COUNT = 0.002, 12.0, 6.0e4, 1.2e3, 1e-6
"""Period (s), mass (kg), gains (N/m, N/(m/s)) and encoder count (m) of the driven slide."""


def reference(t):
    return 0.04 * np.sin(1.3 * t) + 0.015 * np.sin(4.1 * t + 0.4)


def driven(seconds=16.0, coulomb=0.0, viscous=0.0, offset=0.0, limit=np.inf, fine=20, mass=MASS):
    """Position, reference and command (n, 3) of a mass under a PD law, with a smoothed friction law, midpoint steps."""
    n, h = int(seconds / PERIOD), PERIOD / fine
    q, v, last = float(reference(0.0)), 0.0, float(reference(0.0))
    rows = np.empty((n, 3))
    for k in range(n):
        read, asked = COUNT * round(q / COUNT), float(reference(k * PERIOD))
        u = min(max(KP * (asked - read) - KD * (read - last) / PERIOD, -limit), limit)
        rows[k], last = (read, asked, u), read
        for _ in range(fine):
            a = (u - viscous * v - coulomb * float(np.tanh(v / 2e-4)) - offset) / mass
            q, v = q + h * (v + 0.5 * h * a), v + h * a
    return rows


def described(**changes) -> AxesDescription:
    """The driven slide, with changed fields of its axis."""
    axis = {
        "name": "slide",
        "motion": "linear",
        "signals": {x: {"column": x, "unit": u} for x, u in (("position", "m"), ("reference", "m"), ("command", "N"))},
        "command_law": {"kind": "force", "position_gain": KP, "velocity_gain": KD, "held": True},
        "mass": MASS,
        "encoder_resolution": COUNT,
        **changes,
    }
    time = {"column": "t", "unit": "s"}
    return AxesDescription.model_validate({"kind": "axes", "name": "test", "time": time, "axes": [axis]})


def axis_of(**changes) -> Axis:
    return described(**changes).axes[0]


def machine(**changes) -> Axes:
    return Axes(described(**changes))


def run_of(rows, **more) -> AxesRun:
    signals = dict(zip(("position", "reference", "command"), rows.T, strict=True))
    return AxesRun("run", PERIOD, {"slide": {**signals, **more}})


def verdict_of(rows, without=(), **changes):
    return diagnose(machine(**changes), [run_of(rows)], without).verdict


def columns(*names: str, unit: str = "m") -> dict[str, dict[str, str]]:
    """Signals of an axis, each in a column of its own name."""
    return {name: {"column": name, "unit": unit} for name in names}


def servo(**changes) -> Axes:
    """A rotary position servo with a count of 1 mrad."""
    fields = {"motion": "rotary", "signals": columns("position", "reference", unit="rad"), "mass": None}
    return machine(**{**fields, "command_law": {"kind": "position"}, "encoder_resolution": 1e-3, **changes})


def effects(verdict) -> Sequence[str]:
    return [cause.effect for cause in verdict.causes]
