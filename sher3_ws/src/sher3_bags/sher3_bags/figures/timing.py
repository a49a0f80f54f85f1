"""When the samples of each topic were stamped and recorded."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from sher3_description import Robot

from sher3_bags.figures.gaps import count_gaps, grid_periods, is_stamped
from sher3_bags.figures.statistics import Spread, common
from sher3_bags.run import Run, Stream

NODE_OF_TOPIC = {
    "setpoint_js": "kinematics",
    "servo_jv": "kinematics",
    "measured_cp": "kinematics",
    "servo_cv": "admittance",
    "drives/setpoint_jv": "motor_driver",
    "drives/measured_js": "motor_driver",
    "measured_js": "motor_driver",
    "force/measured_cf": "force_sensor",
    "pedal/measured": "pedal",
    "temperature": "plant",
    "tracker/measured_cp": "plant",
    "operating_state": "supervisor",
    "admittance": "admittance",
    "motion": "kinematics",
    "supervisor": "supervisor",
}
"""The node that publishes a topic, or every topic whose name begins so (architecture page, one tick)."""


@dataclass(frozen=True)
class TopicTiming:
    """Timing of one topic; times in s.

    Attributes:
        node: Node that publishes the topic, where it is known.
        messages: Number of messages recorded.
        rate: Messages per second, over the time from the topic's first to its last message.
        period: Time between arrivals at the recorder; between stamps where no times of arrival were recorded.
        off_grid: Largest distance of a stamp from the grid through the first stamp; None without a grid.
        latency: Time from the stamp of a sample to its arrival; None where no times of arrival were recorded.
        from_force: Time from the arrival of a tick's force to the arrival of this topic's sample of the same tick.
        dropped: Samples missing on the grid; pauses of the source are not counted.
        pauses: Gaps longer than a quarter of a second.
        disordered: Number of stamps that repeat or go backwards.
        not_finite: Number of values that are NaN or infinite.
    """

    node: str
    messages: int
    rate: float
    period: Spread | None
    off_grid: float | None
    latency: Spread | None
    from_force: Spread | None
    dropped: int
    pauses: int
    disordered: int
    not_finite: int


def topic_timing(run: Run, robot: Robot) -> dict[str, TopicTiming]:
    """Return the timing of every topic of a run."""
    periods = grid_periods(robot)
    force = run.streams.get("force/measured_cf")
    return {topic: _timing(topic, table, periods.get(topic), force) for topic, table in run.streams.items()}


def _timing(topic: str, table: Stream, period: int | None, force: Stream | None) -> TopicTiming:
    gaps = count_gaps(table.stamp, period, is_stamped(topic))
    arrivals = _arrivals(table)
    span = (table.stamp[-1] - table.stamp[0]) * 1e-9 if len(table) > 1 else 0.0
    return TopicTiming(
        node=NODE_OF_TOPIC.get(topic) or NODE_OF_TOPIC.get(topic.split("/")[0], ""),
        messages=len(table),
        rate=(len(table) - 1) / span if span > 0 else 0.0,
        period=Spread.of(np.diff(table.stamp if arrivals is None else arrivals) * 1e-9),
        off_grid=_off_grid(table, period),
        latency=None if arrivals is None else Spread.of((arrivals - table.stamp) * 1e-9),
        from_force=_from_force(table, force),
        dropped=gaps.dropped,
        pauses=gaps.pauses,
        disordered=gaps.disordered,
        not_finite=_not_finite(table),
    )


def _arrivals(table: Stream) -> np.ndarray | None:
    """Return the log times if they are times of arrival, else None.

    A synthetic run is logged at its stamps; its log times tell nothing about arrival.
    """
    if table.log_time is None or np.array_equal(table.log_time, table.stamp):
        return None
    return table.log_time


def _off_grid(table: Stream, period: int | None) -> float | None:
    if period is None or not len(table):
        return None
    phase = (table.stamp - table.stamp[0] + period // 2) % period - period // 2
    return float(np.abs(phase).max() * 1e-9)


def _from_force(table: Stream, force: Stream | None) -> Spread | None:
    if force is None or table is force or _arrivals(table) is None or _arrivals(force) is None:
        return None
    mine, its = common(table.stamp, force.stamp)
    assert table.log_time is not None and force.log_time is not None
    return Spread.of((table.log_time[mine] - force.log_time[its]) * 1e-9)


def _not_finite(table: Stream) -> int:
    numeric = (column for column in table.columns.values() if isinstance(column, np.ndarray))
    return int(sum((~np.isfinite(column)).sum() for column in numeric))
