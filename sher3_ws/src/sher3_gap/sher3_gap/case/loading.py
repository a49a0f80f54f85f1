"""From bags to signals: alignment on the tick grid, known loads, and the checks that refuse data no answer could
rest on.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from sher3_bags import Case, Run, read_case
from sher3_common.progress import Say, silent
from sher3_description import Robot, load_robot
from sher3_description.contract import GRAVITY
from sher3_diagnosis.channel import Array
from sher3_diagnosis.filter import low_pass

from sher3_gap.case.audit import check_parameters
from sher3_gap.case.ticks import Gap, check_finite, in_order, is_live, on_grid, tick_grid
from sher3_gap.errors import CaseError
from sher3_gap.signals import RAMP_LIMIT, RunSignals
from sher3_gap.stages.exact.law import with_lateness

LOADED = 0.15
"""Force beside the tool's weight [N] from which a tip is not free."""


def load_case(path: Path, robot: Path | None = None, say: Say = silent) -> tuple[list[RunSignals], Robot]:
    """Read a contract case; `say` takes a line of progress.

    Raises:
        CaseError: no run carries the motor encoders, stamps are not a tick grid, values are not finite, runs disagree.
    """
    case: Case = read_case(path, check=False, say=say)
    model = load_robot(robot) if robot is not None else case.robot
    check_parameters(case)
    runs = [signals_of(run, model, f"run {i}") for i, run in enumerate(case.runs)]
    first = min(run.start for run in runs)
    return [replace(run, session_time=(run.start - first) * 1e-9) for run in runs], model


def signals_of(run: Run, robot: Robot, label: str = "run") -> RunSignals:
    """Align one run on its tick grid; see `RunSignals`. Raises `CaseError`."""
    if "drives/measured_js" not in run:
        raise CaseError(f"{label}: topic drives/measured_js is missing", remedy="record the drives' streams")
    name = run.path.name if run.path else label
    run = in_order(run)
    stamps, lost = tick_grid(run["drives/measured_js"].stamp, robot.control_period, name)
    period = robot.control_period

    def column(topic: str, *fields: str, gap: Gap = "line", counts: bool = True) -> Array | None:
        if topic not in run:
            return None
        stream = run[topic]
        values = [getattr(stream, f) for f in fields]
        if any(v is None for v in values):
            return None
        table = np.hstack([np.atleast_2d(np.asarray(v, dtype=float).T).T for v in values])
        out, missing = on_grid(stream.stamp, table, stamps, f"{name}: {topic}", gap)
        if counts:
            np.logical_or(lost, missing, out=lost)
        return out

    wrench = column("force/measured_cf", "force", "torque", counts=False)
    contact, known = _contact(run, wrench, stamps, period)
    tracker = _tracker(run, stamps, period, name)
    motor = column("drives/measured_js", "position")
    if motor is None:
        raise CaseError(f"{name}: drives/measured_js carries no position", remedy="record the motor encoders")
    signals = RunSignals(
        name=name,
        excitation=run.metadata.excitation,
        repeat=run.metadata.repeat,
        period=period,
        stage_clock=np.arange(len(stamps), dtype=np.float64) * period,
        motor=motor,
        effort=column("drives/measured_js", "effort"),
        reference=column("setpoint_js", "position"),
        reference_velocity=column("setpoint_js", "velocity"),
        command=column("servo_jv", "velocity", gap="hold"),
        echo=column("drives/setpoint_jv", "velocity", gap="next"),
        load=column("measured_js", "position"),
        wrench=wrench,
        contact=contact,
        contact_known=known,
        temperature=_temperature(run, stamps, name),
        payload=run.metadata.payload,
        start=int(stamps[0]),
        lost=lost if lost.any() else None,
        **tracker,  # type: ignore[arg-type]
    )
    return with_lateness(signals, robot) if is_live(run) else signals


def free(wrench: Array, robot: Robot) -> np.ndarray:
    """Ticks at which no more than the tool's weight, in any orientation, acts on the force sensor, (n,)."""
    weight = robot.force_sensor.tool_mass * GRAVITY
    return np.linalg.norm(wrench[:, :3], axis=1) < weight + LOADED


def _contact(run: Run, wrench: Array | None, ticks: np.ndarray, period: float) -> tuple[Array, np.ndarray]:
    """Known tip load per tick and where it is known: not on the ramps to and from the stated plateaus.

    Without set-points somebody guides the tool, and his force is not known at any time.
    """
    clock = (ticks - ticks[0]) * 1e-9
    contact, known = np.zeros((len(ticks), 3)), np.ones(len(ticks), dtype=bool)
    if not run.metadata.payload:
        return contact, known if "setpoint_js" in run else ~known
    ramps = np.zeros(len(ticks), dtype=bool)
    plateau = np.zeros(len(ticks), dtype=bool)
    for start, stop, *force in run.metadata.payload:
        inside = (clock >= start) & (clock <= stop)
        contact[inside] = force
        plateau |= inside
        ramps |= (clock >= start - RAMP_LIMIT) & (clock < start)
        ramps |= (clock > stop) & (clock <= stop + RAMP_LIMIT)
    if wrench is not None:
        smallest = min(float(np.abs(row[2:]).max()) for row in run.metadata.payload)
        ramps &= ~_unloaded(wrench, ramps | plateau, period, smallest)
    return contact, plateau | ~ramps


def _unloaded(wrench: Array, doubtful: np.ndarray, period: float, smallest: float) -> np.ndarray:
    """Doubtful ticks at which the force neither changes nor differs from the tip's unloaded reading.

    None where the `smallest` load is too small for the reading to tell.
    """
    force = low_pass(wrench[:, :3], period, 30.0)
    rest = force[~doubtful]
    if len(rest) < 50:
        return np.zeros(len(force), dtype=bool)
    rate = np.abs(np.gradient(force, period, axis=0)).max(axis=1)
    quiet = 6.0 * np.median(rate[~doubtful]) + 1e-12
    level = np.abs(force - np.median(rest, axis=0)).max(axis=1)
    spread = 6.0 * np.abs(rest - np.median(rest, axis=0)).max(axis=1).mean() + 0.01
    if spread > 0.15 * smallest:
        return np.zeros(len(force), dtype=bool)
    return (rate < quiet) & (level < spread)


def _tracker(run: Run, ticks: np.ndarray, period: float, name: str) -> dict[str, np.ndarray]:
    if "tracker/measured_cp" not in run:
        return {}
    stream = run["tracker/measured_cp"]
    check_finite(f"{name}: tracker/measured_cp", np.hstack([stream.position, stream.orientation]))
    index = np.clip(np.searchsorted(ticks, stream.stamp - int(0.5e9 * period)), 0, len(ticks) - 1)
    near = np.abs(ticks[index] - stream.stamp) < 0.5e9 * period
    return {
        "tracker_index": index[near],
        "tracker_position": np.asarray(stream.position)[near],
        "tracker_rotation": np.asarray(stream.orientation)[near],
    }


def _temperature(run: Run, ticks: np.ndarray, name: str) -> Array | None:
    if "temperature" not in run or len(run["temperature"]) == 0:
        return None
    stream = run["temperature"]
    check_finite(f"{name}: temperature", np.asarray(stream.temperature)[:, None])
    clock, reading = (stream.stamp - ticks[0]) * 1e-9, np.asarray(stream.temperature, dtype=float)
    degree = 1 if len(reading) >= 3 else 0
    slope = np.polynomial.Polynomial.fit(clock, reading, degree)
    return slope((ticks - ticks[0]) * 1e-9)
