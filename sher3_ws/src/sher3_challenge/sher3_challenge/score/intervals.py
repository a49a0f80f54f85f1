"""Intervals: whether stated ones of parameters hold the truth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SYNONYMS = {
    "delay": "delay latency dead_time tau",
    "time_constant": "time_constant tau lag tau_lag",
    "relative": "relative delta scale error gain_error ratio_error epsilon",
    "skew": "skew delay tau",
    "limit": "limit u_max saturation",
    "force": "force fc coulomb f_c level",
    "extra": "extra viscous f_v fv coefficient",
    "amplitude": "amplitude a amp",
    "width": "width gap b backlash",
    "clearance": "clearance c width gap",
    "stiffness": "stiffness k",
    "compliance": "compliance c",
    "mass": "mass dm tool_mass",
    "offset": "offset q0",
    "length": "length dl delta_l",
    "periods_per_rev": "periods_per_rev n order harmonic",
    "frequency": "frequency f f0",
    "coefficient": "coefficient alpha",
    "probability": "probability p p_drop",
    "sigma": "sigma jitter",
    "x": "x dx",
    "y": "y dy",
    "z": "z dz",
}
"""Names under which a verdict may state a parameter of the truth."""


def parameter_coverage(effect: Mapping[str, Any], cause: Mapping[str, Any]) -> tuple[int, int]:
    """Return how many true parameters the cause states with an interval, and how many of those it holds, sign free."""
    stated = {name.lower(): value for name, value in (cause.get("parameters") or {}).items()}
    found = inside = 0
    for name, true in effect.get("parameters", {}).items():
        for synonym in SYNONYMS.get(name, name).split():
            interval = stated.get(synonym) or {}
            low, high = interval.get("low"), interval.get("high")
            if low is None or high is None:
                continue
            found += 1
            inside += low <= true <= high or low <= -true <= high
            break
    return found, inside
