"""From bags to signals: alignment on the tick grid, known loads, and the checks that refuse data no answer could
rest on.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from sher3_bags import Case, Run, read_case
from sher3_description import Robot, load_robot

from sher3_gap.audit import check_parameters
from sher3_gap.channels import Array
from sher3_gap.errors import CaseError as CaseError
from sher3_gap.signals import RunSignals, low_pass

RAMP_LIMIT = 0.25
"""Longest time from an unloaded tip to a stated plateau over which the load is taken as unknown, s."""


def load_case(path: Path, robot: Path | None = None) -> tuple[list[RunSignals], Robot]:
    """Read a contract case.

    Raises:
        CaseError: no run carries the motor encoders, stamps are not a tick grid, values are not finite, runs disagree.
    """
    case: Case = read_case(path, check=False)
    model = load_robot(robot) if robot is not None else case.robot
    check_parameters(case)
    runs = [signals_of(run, model, f"run {i}") for i, run in enumerate(case.runs)]
    first = min(run.start for run in runs)
    return [replace(run, session_time=(run.start - first) * 1e-9) for run in runs], model


def signals_of(run: Run, robot: Robot, label: str = "run") -> RunSignals:
    """Align one run on its tick grid; see `RunSignals`. Raises `CaseError`."""
    if "drives/measured_js" not in run:
        raise CaseError(f"{label}: topic drives/measured_js is missing", remedy="record the drives' streams")
    measured = run["drives/measured_js"]
    stamps, name = measured.stamp, (run.path.name if run.path else label)
    period = _period(stamps, robot.control_period, name)
    ticks = len(stamps)

    def column(topic: str, *fields: str) -> Array | None:
        if topic not in run:
            return None
        stream = run[topic]
        values = [getattr(stream, f) for f in fields]
        if any(v is None for v in values):
            return None
        table = np.hstack([np.atleast_2d(np.asarray(v, dtype=float).T).T for v in values])
        return _on_grid(stream.stamp, table, stamps, f"{name}: {topic}")

    wrench = column("force/measured_cf", "force", "torque")
    contact, known = _contact(run, wrench, stamps, period)
    tracker = _tracker(run, stamps, period)
    motor = column("drives/measured_js", "position")
    if motor is None:
        raise CaseError(f"{name}: drives/measured_js carries no position", remedy="record the motor encoders")
    return RunSignals(
        name=name,
        excitation=run.metadata.excitation,
        repeat=run.metadata.repeat,
        period=period,
        stage_clock=np.arange(ticks, dtype=np.float64) * period,
        motor=motor,
        effort=column("drives/measured_js", "effort"),
        reference=column("setpoint_js", "position"),
        reference_velocity=column("setpoint_js", "velocity"),
        command=column("servo_jv", "velocity"),
        echo=column("drives/setpoint_jv", "velocity"),
        load=column("measured_js", "position"),
        wrench=wrench,
        contact=contact,
        contact_known=known,
        temperature=_temperature(run, stamps),
        payload=run.metadata.payload,
        start=int(stamps[0]),
        **tracker,  # type: ignore[arg-type]
    )


def _period(stamps: np.ndarray, expected: float, name: str) -> float:
    steps = np.diff(stamps)
    if len(steps) < 100:
        raise CaseError(
            f"{name}: too short", value=f"{len(stamps)} ticks", limit="101 ticks", remedy="record longer runs"
        )
    if (steps <= 0).any():
        at = int(np.argmax(steps <= 0))
        raise CaseError(f"{name}: the clock jumps back at tick {at}", value=f"{steps[at] * 1e-9:.6f} s", limit="> 0 s")
    period = float(np.median(steps)) * 1e-9
    if abs(period / expected - 1.0) > 0.01:
        raise CaseError(
            f"{name}: tick period differs from robot.yaml's control_period",
            value=f"{period:.6f} s",
            limit=f"{expected:.6f} s",
            remedy="use the robot.yaml that was in force",
        )
    if steps.max() > 1.5e9 * period:
        at = int(np.argmax(steps))
        raise CaseError(
            f"{name}: ticks are missing after tick {at}",
            value=f"{steps[at] * 1e-9:.6f} s",
            limit=f"{period:.6f} s",
            remedy="cut the run at the hole, or record without drops",
        )
    return expected


def _on_grid(stamp: np.ndarray, values: Array, ticks: np.ndarray, what: str) -> Array:
    if not np.isfinite(values).all():
        at = int(np.argmax(~np.isfinite(values).all(axis=1)))
        raise CaseError(f"{what}: not a finite number in sample {at}", value=str(values[at]), remedy="drop this run")
    if len(stamp) == len(ticks) and (stamp == ticks).all():
        return np.ascontiguousarray(values)
    nearest = np.clip(np.searchsorted(stamp, ticks, side="right") - 1, 0, len(stamp) - 1)
    lost = np.count_nonzero(stamp[nearest] != ticks)
    if lost > 0.002 * len(ticks):
        raise CaseError(f"{what}: samples are missing", value=f"{lost} of {len(ticks)}", limit="0.2 %")
    return np.ascontiguousarray(values[nearest])


def _contact(run: Run, wrench: Array | None, ticks: np.ndarray, period: float) -> tuple[Array, np.ndarray]:
    """Known tip load per tick and where it is known: not on the ramps to and from the stated plateaus."""
    clock = (ticks - ticks[0]) * 1e-9
    contact, known = np.zeros((len(ticks), 3)), np.ones(len(ticks), dtype=bool)
    if not run.metadata.payload:
        return contact, known
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


def _tracker(run: Run, ticks: np.ndarray, period: float) -> dict[str, np.ndarray]:
    if "tracker/measured_cp" not in run:
        return {}
    stream = run["tracker/measured_cp"]
    if not (np.isfinite(stream.position).all() and np.isfinite(stream.orientation).all()):
        raise CaseError("tracker/measured_cp: not a finite number", remedy="drop this run")
    index = np.clip(np.searchsorted(ticks, stream.stamp - int(0.5e9 * period)), 0, len(ticks) - 1)
    near = np.abs(ticks[index] - stream.stamp) < 0.5e9 * period
    return {
        "tracker_index": index[near],
        "tracker_position": np.asarray(stream.position)[near],
        "tracker_rotation": np.asarray(stream.orientation)[near],
    }


def _temperature(run: Run, ticks: np.ndarray) -> Array | None:
    if "temperature" not in run or len(run["temperature"]) == 0:
        return None
    stream = run["temperature"]
    if not np.isfinite(stream.temperature).all():
        raise CaseError("temperature: not a finite number", remedy="drop this run")
    clock, reading = (stream.stamp - ticks[0]) * 1e-9, np.asarray(stream.temperature, dtype=float)
    degree = 1 if len(reading) >= 3 else 0
    slope = np.polynomial.Polynomial.fit(clock, reading, degree)
    return slope((ticks - ticks[0]) * 1e-9)
