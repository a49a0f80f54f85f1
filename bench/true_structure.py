"""What a record shows of the true causes of a drawn machine, by a fit that knows their structure: no diagnosis in it.

The force balance is linear in the sizes once the laws are known: true delay, true speed at which friction has fallen,
true arm. A cause has power where the fit with it tells parts of the record that it was not made on better than the fit
without it, by two standard errors over the parts, and where its size is as far from zero.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray
from sher3_chain.joint.description import Axis
from sher3_chain.readings.signals import AxisSignals, signals_of
from sher3_diagnosis.filter import low_pass

Array = NDArray[np.float64]
PARTS = 10
"""Parts of a record, each left out once."""
SURE = 2.0
"""Standard errors over the parts."""
STILL = 0.01
"""Share of the top speed below which a friction holds: any force up to its level."""
SPREAD = 0.35
"""Periods of the cut-off by which the filter spreads what lies there."""
ENDS = 0.3
"""Time at either end that is left out, s."""


def powerless(drawn) -> set[str]:
    """Return the causes of a drawn machine (`Drawn`) that its record does not show."""
    x, y, ok = balance(drawn, drawn.late)
    out = not_shown(x, y, ok, drawn.truth)
    if drawn.late:
        punctual, said, judged = balance(drawn, 0.0)
        late = {"sensor_delay", "delay"} & set(drawn.truth)
        out |= set() if _better(left_out(punctual, said, ok & judged)[0], left_out(x, y, ok & judged)[0]) else late
    return out


def not_shown(x: dict[str, Array], y: Array, ok: NDArray[np.bool_], sought: Collection[str]) -> set[str]:
    """Return the sought columns that parts left out are told no better with, or whose size is not told from zero."""
    whole, beta, error = left_out(x, y, ok)
    out = {n for n, b, e in zip(x, beta, error, strict=True) if n in sought and abs(b) < SURE * e}
    for name in (n for n in x if n in sought):
        out |= set() if _better(left_out({k: v for k, v in x.items() if k != name}, y, ok)[0], whole) else {name}
    return out


def _better(without: Array, whole: Array) -> bool:
    gain = without - whole
    return bool(gain.mean() > SURE * gain.std(ddof=1) / np.sqrt(PARTS))


def left_out(columns: dict[str, Array], y: Array, ok: NDArray[np.bool_]) -> tuple[Array, Array, Array]:
    """Return squares (PARTS,) left on parts left out, sizes and their standard errors by the jackknife."""
    x, y = np.column_stack(list(columns.values()))[ok], y[ok]
    losses, sizes = [], []
    for part in np.array_split(np.arange(len(y)), PARTS):
        told = np.delete(np.arange(len(y)), part)
        beta = np.linalg.lstsq(x[told], y[told], rcond=None)[0]
        losses.append(np.sum((y[part] - x[part] @ beta) ** 2))
        sizes.append(beta)
    error = np.sqrt((PARTS - 1) / PARTS * np.sum((np.array(sizes) - np.mean(sizes, axis=0)) ** 2, axis=0))
    return np.array(losses), np.linalg.lstsq(x, y, rcond=None)[0], error


def balance(drawn, late: float) -> tuple[dict[str, Array], Array, NDArray[np.bool_]]:
    """Return columns by cause, what they are to explain, (n,), and which samples can be judged.

    Args:
        drawn: the machine.
        late: delay that is put right before, s.
    """
    axis: Axis = drawn.machine.described.axes[0]
    run = signals_of(drawn.run, axis, "run")
    smooth = low_pass(run.motor, run.period, run.bandwidth)[:, 0]
    v = np.gradient(smooth, run.period)
    a = np.gradient(v, run.period)
    columns = _laws(drawn, run, v, a)
    if axis.servo:
        y = _moved(run.reference, run, -late) - run.motor[:, 0]
    else:
        effort = _moved(run.effort, run, late)
        y = effort - axis.mass * a - axis.gravity.arm * np.sin(run.motor[:, 0])
        columns |= {"torque_constant": -effort} if "torque_constant" in drawn.truth else {}
    table = np.column_stack([*columns.values(), y])
    filtered = low_pass(table, run.period, run.bandwidth)
    reach = int(np.ceil(SPREAD / (run.bandwidth * run.period)))
    still = np.convolve(np.abs(v) < STILL * np.abs(v).max(), np.ones(2 * reach + 1), "same") > 0.5
    end = int(ENDS / run.period)
    still[:end] = still[-end:] = True
    return dict(zip(columns, filtered.T[:-1], strict=True)), filtered[:, -1], ~still


def _laws(drawn, run: AxisSignals, v: Array, a: Array) -> dict[str, Array]:
    """Return the column of each law in the truth, less the delay and the gain; the first is a zero's, which is free."""
    q, top = run.motor[:, 0], float(np.abs(v).max())
    sign = np.tanh(v / (STILL * top))
    arm = "arm" in drawn.truth.get("gravity_load", {})
    falls = sign * np.exp(-((v / (drawn.falls or top)) ** 2))
    laws = {
        "payload_mass": a,
        "viscous_friction": v,
        "coulomb_friction": sign,
        "stribeck_friction": falls,
        "gravity_load": np.sin(q) if arm else np.ones_like(q),
        "spring_torque": q - q.mean(),
    }
    chosen = {n: x for n, x in laws.items() if n in drawn.truth}
    chosen |= {"sliding": sign} if "stribeck_friction" in chosen else {}
    chosen |= {"zero": np.ones_like(q)} if arm or "gravity_load" not in chosen else {}
    return chosen | ({"drive_lag": v, "mass": a} if drawn.kind == "servo" else {})


def _moved(x: Array, run: AxisSignals, by: float) -> Array:
    """Return a signal (n, 1) as it is `by` seconds later, (n,)."""
    return np.interp(run.stage_clock + by, run.stage_clock, x[:, 0])
