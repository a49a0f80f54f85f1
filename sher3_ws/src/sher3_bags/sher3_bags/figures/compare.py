"""Compare two runs on header time: alignment, lag, residual statistics per topic, column and axis."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray
from sher3_common.errors import Sher3Error
from sher3_common.stamps import seconds
from sher3_description import ACTUATORS

from sher3_bags.errors import BagError
from sher3_bags.figures.units import unit_of
from sher3_bags.messages import TYPES
from sher3_bags.run import Run, Stream

MAX_LAG = 0.5
"""Largest lag [s] that is looked for: the loop answers within tens of ms, so a longer lag is another motion."""
MIN_CORRELATION = 0.5
"""Correlation coefficient below which two signals count as unrelated and no lag is told."""
MIN_PROMINENCE = 0.01
"""Least drop of the correlation from its peak to an end of the range: a straight line correlates at every lag."""
_STAMP_ROUNDING = 1e-9
"""Slack [s] at the ends of a run: stamps are whole ns."""
_CONSTANT = 1e-12
"""A signal whose range is below this share of its magnitude is constant but for rounding."""
_TINY = 1e-300
"""Keeps a division defined where both of its terms are zero."""
Alignment = Literal["auto", "stamp", "start"]


@dataclass(frozen=True)
class AxisResidual:
    """How one axis of one column of run b differs from the same axis of run a.

    Attributes:
        axis: Name of the actuator or component.
        unit: SI unit of `mean`, `rms`, `max` and `rms_aligned`; empty for a pure number.
        lag: Time [s] by which b is later than a: the peak of the normalised cross-correlation with the means removed.
            None when there is no clear peak: the signals are constant, straight lines or unrelated.
        correlation: Correlation coefficient at that lag; without a lag, at zero shift.
        mean: Mean of b - a without shift.
        rms: Root mean square of b - a without shift.
        max: Largest magnitude of b - a without shift.
        rms_aligned: Root mean square of b - a with lag and mean removed; None without a lag.
    """

    axis: str
    unit: str
    lag: float | None
    correlation: float | None
    mean: float
    rms: float
    max: float
    rms_aligned: float | None


@dataclass(frozen=True)
class Comparison:
    """Two runs side by side.

    Attributes:
        a, b: Paths of the bags.
        alignment: `stamp` when the runs are compared at equal stamps, `start` when each is counted from its own start.
        shift: Time [ns] that was added to the stamps of b.
        overlap: Time [s] that both runs cover.
        lag: Median lag [s] of all axes; None when no axis has one.
        residuals: Residuals by topic and column.
        only_in_a, only_in_b: Topics that only one of the runs has.
        messages: Number of messages in a and in b, by topic.
    """

    a: str
    b: str
    alignment: str
    shift: int
    overlap: float
    lag: float | None
    residuals: dict[str, dict[str, tuple[AxisResidual, ...]]]
    only_in_a: tuple[str, ...]
    only_in_b: tuple[str, ...]
    messages: dict[str, tuple[int, int]]

    def to_dict(self) -> dict[str, Any]:
        """Return the comparison as plain data."""
        return asdict(self)


def alignment_from(text: str) -> Alignment:
    """Return the alignment with this name.

    Raises:
        Sher3Error: No alignment has this name.
    """
    for name in get_args(Alignment):
        if name == text:
            return name
    raise Sher3Error("unknown alignment", value=text, limit=", ".join(get_args(Alignment)))


def compare(a: Run, b: Run, *, alignment: Alignment = "auto", topics: Iterable[str] | None = None) -> Comparison:
    """Compare run b with run a; b is interpolated at the stamps of a.

    Args:
        a: The reference.
        b: The other run.
        alignment: `stamp` compares at equal stamps, `start` at equal times since each run's first stamp; `auto` takes
            `stamp` when the runs overlap by at least half of the shorter one, else `start`.
        topics: Compare these topics only; by default all that both runs have.

    Raises:
        BagError: The runs do not overlap, or have no topic in common.
    """
    wanted = set(a.streams) | set(b.streams) if topics is None else set(topics)
    both = [topic for topic in a.streams if topic in b and topic in wanted and a[topic].type == b[topic].type]
    if not both:
        raise BagError("no topic in common", path=b.path, value=", ".join(b.streams), limit=", ".join(a.streams))
    span_a, span_b = _span(a, both), _span(b, both)
    if alignment == "auto":
        alignment = _best_alignment(span_a, span_b)
    shift = 0 if alignment == "stamp" else span_a[0] - span_b[0]
    overlap = _overlap(span_a, (span_b[0] + shift, span_b[1] + shift))
    if overlap <= 0:
        remedy = "compare them from their starts (alignment 'start')"
        raise BagError("the runs do not overlap in time", path=b.path, value="0.0 s", remedy=remedy)
    residuals = {topic: _compare_streams(a[topic], b[topic], shift) for topic in both}
    residuals = {topic: columns for topic, columns in residuals.items() if columns}
    return Comparison(
        a=str(a.path or ""),
        b=str(b.path or ""),
        alignment=alignment,
        shift=shift,
        overlap=seconds(overlap),
        lag=_median_lag(residuals),
        residuals=residuals,
        only_in_a=tuple(t for t in a.streams if t in wanted and t not in b),
        only_in_b=tuple(t for t in b.streams if t in wanted and t not in a),
        messages={topic: (len(a[topic]), len(b[topic])) for topic in both},
    )


def _best_alignment(span_a: tuple[int, int], span_b: tuple[int, int]) -> Alignment:
    """Return `stamp` when the spans [ns] share at least half of the shorter one, else `start`."""
    shorter = min(span_a[1] - span_a[0], span_b[1] - span_b[0])
    return "stamp" if 2 * _overlap(span_a, span_b) >= shorter else "start"


def _overlap(one: tuple[int, int], other: tuple[int, int]) -> int:
    """Return the length of what two spans share [ns], 0 if they share nothing."""
    return max(0, min(one[1], other[1]) - max(one[0], other[0]))


def _median_lag(residuals: dict[str, dict[str, tuple[AxisResidual, ...]]]) -> float | None:
    lags = [r.lag for columns in residuals.values() for axes in columns.values() for r in axes if r.lag is not None]
    return float(np.median(lags)) if lags else None


def _span(run: Run, topics: list[str]) -> tuple[int, int]:
    """Return the first and last header stamp [ns] of the given topics.

    Topics that only one of two runs recorded are left out by the caller: they must not shift the start of that run.
    """
    stamps = [run[t].stamp for t in topics if TYPES[run[t].type].header and len(run[t])]
    return min((int(s[0]) for s in stamps), default=0), max((int(s[-1]) for s in stamps), default=0)


def _compare_streams(a: Stream, b: Stream, shift: int) -> dict[str, tuple[AxisResidual, ...]]:
    origin = int(a.stamp[0])
    time_a, time_b = (a.stamp - origin) * 1e-9, (b.stamp + (shift - origin)) * 1e-9
    result = {}
    for name, column in a.columns.items():
        other = b.columns.get(name)
        if not isinstance(column, np.ndarray) or other is None:
            continue
        one, two = column.reshape(len(a), -1), other.reshape(len(b), -1)
        if one.shape[1] != two.shape[1]:
            continue
        if name == "orientation":
            one, two = _continuous(one), _continuous(two)
            two = two * (np.sign(one[0] @ two[0]) or 1.0)
        axes = [
            _compare_axis(
                axis, unit_of(a.type, name, axis), time_a, one[:, k].astype(float), time_b, two[:, k].astype(float)
            )
            for k, axis in enumerate(_axes(name, one.shape[1]))
        ]
        result[name] = tuple(axis for axis in axes if axis is not None)
    return {name: axes for name, axes in result.items() if axes}


def _continuous(quaternion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Choose the signs of (n, 4) quaternions such that neighbours are close."""
    flips = np.where((quaternion[1:] * quaternion[:-1]).sum(axis=1) < 0, -1.0, 1.0)
    return quaternion * np.cumprod(np.r_[1.0, flips])[:, None]


def _axes(column: str, width: int) -> tuple[str, ...]:
    if width == len(ACTUATORS):
        return ACTUATORS
    return tuple("xyzw"[:width]) if width in (3, 4) else tuple(f"{column}[{k}]" for k in range(width))


def _compare_axis(
    axis: str, unit: str, time_a: NDArray[Any], a: NDArray[Any], time_b: NDArray[Any], b: NDArray[Any]
) -> AxisResidual | None:
    good_a, good_b = np.isfinite(a), np.isfinite(b)
    time_a, a, time_b, b = time_a[good_a], a[good_a], time_b[good_b], b[good_b]
    if len(a) < 2 or len(b) < 2:
        return None
    inside = (time_a >= time_b[0] - _STAMP_ROUNDING) & (time_a <= time_b[-1] + _STAMP_ROUNDING)
    if inside.sum() < 2:
        return None
    difference = np.interp(time_a[inside], time_b, b) - a[inside]
    lag, correlation, aligned = _lag(time_a, a, time_b, b)
    return AxisResidual(
        axis,
        unit,
        lag,
        correlation,
        float(difference.mean()),
        float(np.sqrt(np.mean(difference**2))),
        float(np.abs(difference).max()),
        aligned,
    )


def _lag(
    time_a: NDArray[Any], a: NDArray[Any], time_b: NDArray[Any], b: NDArray[Any]
) -> tuple[float | None, float | None, float | None]:
    """Return the lag [s], the correlation there, and the rms with lag and mean removed.

    Without a clear peak lag and rms are None, and the correlation is that at zero shift (None for a constant signal).
    """
    start, end = max(time_a[0], time_b[0]), min(time_a[-1], time_b[-1])
    step = float(np.median(np.diff(time_a)))
    n = int((end - start) / step) + 1
    reach = min(round(MAX_LAG / step), n // 4)
    grid = start + step * np.arange(n)
    x, y = np.interp(grid, time_a, a), np.interp(grid, time_b, b)
    if reach < 2 or min(np.ptp(x), np.ptp(y)) <= _CONSTANT * max(np.abs(x).max(), np.abs(y).max(), _TINY):
        return None, None, None
    r = _correlation(x, y, reach)
    peak = int(np.argmax(r))
    prominence = r[peak] - min(r[0], r[-1])
    if peak in (0, len(r) - 1) or r[peak] < MIN_CORRELATION or prominence < MIN_PROMINENCE:
        return None, float(r[reach]), None
    left, top, right = r[peak - 1 : peak + 2]
    # The vertex of the parabola through the three highest values refines the lag below one period.
    lag = (peak - reach + 0.5 * (left - right) / (left - 2 * top + right)) * step
    shifted = grid[(grid + lag >= start) & (grid + lag <= end)]
    rest = np.interp(shifted + lag, time_b, b) - np.interp(shifted, time_a, a)
    return round(float(lag), 9), float(top), float(rest.std())


def _correlation(x: NDArray[Any], y: NDArray[Any], reach: int) -> NDArray[np.float64]:
    """Return the correlation coefficients of x(k) and y(k + l) for l = -reach..reach, each over its own overlap."""
    n = len(x)
    x, y = x - x.mean(), y - y.mean()
    lags = np.arange(-reach, reach + 1)
    first, count = np.maximum(0, -lags), n - np.abs(lags)
    from scipy.signal import correlate  # slow to import, and not needed before a case is read

    products = correlate(y, x, mode="full", method="fft")[n - 1 - reach : n + reach]

    def sums(values: NDArray[Any], start: NDArray[Any]) -> NDArray[Any]:
        running = np.r_[0.0, np.cumsum(values)]
        return running[start + count] - running[start]

    sx, sy = sums(x, first), sums(y, first + lags)
    vx = sums(x * x, first) - sx * sx / count
    vy = sums(y * y, first + lags) - sy * sy / count
    return np.clip((products - sx * sy / count) / np.sqrt(np.maximum(vx * vy, _TINY)), -1.0, 1.0)
