"""Histograms, the clock grid and ticks, without ROS."""

import inspect

import numpy as np
import pytest
from sher3_runtime import ports
from sher3_runtime.clock import Clock, SteppedClock
from sher3_runtime.process import make_logging_prompt
from sher3_runtime.statistics.report import reports as reports_of
from sher3_runtime.tick import Tick, run_due
from sher3_runtime.timing import Histogram, Statistics


@pytest.mark.parametrize("scale", [1, 40, 1_000, 1_000_000])
def test_percentiles_are_upper_bounds_within_six_percent(scale):
    values = np.random.default_rng(1).lognormal(3.0, 1.0, 20_000) * scale
    histogram = Histogram()
    for value in values:
        histogram.add(int(value))
    for percent in (1, 50, 99, 99.9):
        exact = np.percentile(values.astype(int), percent, method="inverted_cdf")
        assert exact <= histogram.percentile(percent) <= exact * 1.0626
    assert histogram.maximum == int(values.max())
    assert histogram.count == 20_000


def test_small_and_negative_durations():
    histogram = Histogram()
    assert histogram.percentile(50) == 0 and histogram.summary()["count"] == 0
    for value in (-5, 0, 1, 31, 32):
        histogram.add(value)
    assert histogram.percentile(100) == 32 and histogram.percentile(40) == 0 and histogram.percentile(60) == 1


def test_grid_stamps_are_multiples_of_the_period_for_any_offset():
    for offset in (0, 123_456_789, 1_700_000_000_000_000_001):
        clock = Clock(2_000_000, offset)
        tick = Tick(print, 0, 1, clock, Statistics())
        tick.schedule()
        assert tick.due_ns % 2_000_000 == 0 and 0 < tick.due_ns - clock.now() + 1_000_000 < 3_000_000


def test_a_late_tick_runs_once_for_the_latest_stamp():
    """Three and a half periods late: three cycles lost, one call, and the next one is due on the grid."""
    clock, stamps = SteppedClock(1_000_000, 10_000_000), []
    statistics = Statistics()
    tick = Tick(stamps.append, 100_000, 1, clock, statistics)
    tick.schedule()
    assert tick.due_ns == 10_100_000
    tick.run(10_100_000 + 3_500_000)
    assert stamps == [13_000_000]
    assert statistics.lost_cycles == 3 and tick.due_ns == 14_100_000
    tick.run(14_100_000)
    assert stamps == [13_000_000, 14_000_000] and statistics.lost_cycles == 3
    assert statistics.losses() == 3 and dict(statistics.counters())["lost_cycles"] == "3"


def test_a_round_belongs_to_one_period_however_long_it_takes():
    """The first tick takes 1.05 ms in its first round: no cycle is lost, and the order stays."""
    clock, calls, counts = SteppedClock(1_000_000, 10_000_000), [], Statistics()
    clock.time_ns += 500_000

    def driver(stamp):
        calls.append(("driver", stamp))
        clock.time_ns += 200_000 if len(calls) > 1 else 1_050_000

    ticks = [
        Tick(driver, 0, 1, clock, counts),
        Tick(lambda stamp: calls.append(("sensor", stamp)), 10_000, 1, clock, counts),
    ]
    for tick in ticks:
        tick.schedule()
    first = clock.time_ns = ticks[0].due_ns
    clock.time_ns += 20_000
    for late in (70_000, 270_000):
        run_due(ticks, clock)
        assert clock.time_ns == first + 1_000_000 + late
    second = first + 1_000_000
    assert calls == [("driver", first), ("sensor", first), ("driver", second), ("sensor", second)]
    assert counts.lost_cycles == 0


def test_a_report_tells_the_cycles_lost_until_it_is_sent():
    """The supervisor stops for them: counters taken at the beginning of a report would be a second old."""
    statistics = Statistics()
    statistics.wakeup.add(1000)
    reports = reports_of("node", statistics)
    assert next(reports) is None
    statistics.lost_cycles = 7
    report = next(sample for sample in reports if sample is not None)
    assert dict(report.values)["lost_cycles"] == "7" and report.message == "7 losses since the last report"


def test_a_line_that_is_logged_finds_its_caller_without_looking_at_every_module(monkeypatch):
    """That look takes 60 to 110 ms, once in a process; in the motor driver's loop the drives lose their host by it."""
    make_logging_prompt()
    looks = []
    monkeypatch.setattr(inspect, "ismodule", lambda module: looks.append(module) or False)
    assert inspect.getmodule(inspect.currentframe(), ports.__file__) is ports
    assert len(looks) == 1
