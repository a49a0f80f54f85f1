"""Causes of late commands from timings that are written down."""

import numpy as np
import pytest
from recorded import PERIOD, ROBOT, run
from sher3_diagnosis.thresholds import DROPS_SEEN
from sher3_gap.stages.exact.timing import Timing
from sher3_gap.stages.exact.transport import transport_finding

RUNS = [run(1000, command=0.0, echo=0.0)]


def timing(**facts):
    given = {
        "energy": 1.0,
        "constant": 1.0,
        "per_tick": 1.0,
        "latency": np.zeros(5),
        "samples": np.zeros(500),
        "drops": 0.0,
        "scatter": 0.0,
        **facts,
    }
    return Timing(**given)


def found(without=(), **facts):
    return transport_finding(timing(**facts), RUNS, ROBOT, without)


def test_nothing_is_found_where_commands_arrive_on_time():
    assert found(energy=0.0) is None
    assert transport_finding(None, RUNS, ROBOT) is None


def test_a_common_latency_is_a_delay_in_seconds():
    late = {"latency": np.full(5, 1.5), "samples": np.full(500, 1.5), "constant": 0.0, "per_tick": 0.0}
    (cause,) = found(**late).causes
    assert (cause.effect, cause.actuator) == ("command_delay", "all")
    assert cause.parameters["delay"].value == pytest.approx(1.5 * PERIOD)
    assert cause.parameters["delay"].high - cause.parameters["delay"].low == pytest.approx(0.02 * PERIOD)
    assert found(**late).closure.value == pytest.approx(1.0)
    assert found(("command_delay",), **late).causes == []


def test_one_axis_later_than_the_others_is_a_skew_on_that_axis():
    latency = np.array([0.0, 0.8, 0.0, 0.0, 0.0])
    result = found(latency=latency, constant=0.0, per_tick=0.0, apart=1.0)
    (cause,) = result.causes
    assert (cause.effect, cause.actuator) == ("axis_skew", "delta_2")
    assert cause.parameters["skew"].value == pytest.approx(0.8 * PERIOD)
    assert result.where.actuator == "delta_2"


def test_commands_held_for_whole_periods_are_drops():
    samples = np.concatenate([np.zeros(490), np.ones(10)])
    (cause,) = found(samples=samples, drops=0.02, per_tick=0.0).causes
    assert cause.effect == "dropped_commands"
    share = cause.parameters["probability"]
    error = 2.0 * np.sqrt(0.02 * 0.98 / 500) + 0.002
    assert (share.value, share.low, share.high) == (0.02, pytest.approx(0.02 - error), pytest.approx(0.02 + error))
    assert found(samples=samples, drops=DROPS_SEEN, per_tick=0.999).causes == []


def test_drops_are_no_jitter_even_where_they_are_not_in_the_library():
    samples = np.concatenate([np.zeros(490), np.ones(10)])
    late = {"samples": samples, "drops": 0.02, "scatter": 0.14, "constant": 0.9, "per_tick": 0.0}
    result = found(("dropped_commands",), **late)
    assert result.causes == []
    assert result.closure.value == 0.0


def test_lateness_of_a_few_ticks_by_any_time_is_neither_jitter_nor_drops():
    """A limit on how fast the demand may change holds one command in ten back, the longer the larger its step."""
    samples = np.concatenate([np.zeros(900), np.linspace(0.3, 20.4, 100)])
    late = {"samples": samples, "drops": 0.1, "scatter": 0.1, "constant": 0.6, "per_tick": 0.0}
    assert found(**late).causes == []


def test_latencies_that_scatter_are_jitter_with_their_rms():
    samples = np.abs(np.random.default_rng(0).normal(0.0, 0.3, 500))
    scatter = float(samples.std())
    median = np.full(5, float(np.median(samples)))
    facts = {"samples": samples, "scatter": scatter, "latency": median, "constant": 0.5, "per_tick": 0.0}
    (cause,) = found(**facts).causes
    assert cause.effect == "command_jitter"
    assert cause.parameters["sigma"].value == pytest.approx(np.sqrt(np.mean(samples**2)) * PERIOD)
    assert cause.parameters["sigma"].low < 0.3 * PERIOD < cause.parameters["sigma"].high


def test_the_far_tail_of_a_jitter_is_not_taken_for_drops():
    """A hundredth of the ticks late by whole periods carries most of the energy, but most odd ticks are in between."""
    rng = np.random.default_rng(1)
    samples = np.concatenate([rng.gamma(1.7, 0.14, 980), np.ones(10), np.full(10, 2.0)])
    facts = {"samples": samples, "drops": 0.02, "scatter": 0.2, "latency": np.full(5, 0.2)}
    assert [c.effect for c in found(constant=0.4, per_tick=0.0, **facts).causes] == ["command_jitter"]


def test_drops_on_one_axis_are_no_skew_of_it():
    """The best constant latency of an axis whose commands are dropped now and then is the mean of its holds."""
    samples = np.concatenate([np.zeros(480), np.ones(20)])
    facts = {"latency": np.array([0.0, 0.0, 0.0, 0.04, 0.0]), "samples": samples, "drops": 0.04}
    causes = found(constant=0.9, per_tick=0.0, **facts).causes
    assert [c.effect for c in causes] == ["dropped_commands"]


def test_drops_that_come_like_clockwork_are_a_drive_that_samples_its_demand():
    samples = np.tile([0.0, 1.0, 2.0], 200)
    late = {"samples": samples, "drops": 0.33, "scatter": 0.5, "constant": 0.6, "per_tick": 0.0}
    assert [c.effect for c in found(**late).causes] == ["dropped_commands"]
    result = found(clockwork=0.97, **late)
    assert result.causes == []
    assert result.closure.value == 0.0


def test_drops_and_jitter_together_are_both():
    """A jitter of 0.03 periods on all ticks, each twentieth held for a period: 0.05 of it, and 0.03 ms of 1 ms."""
    samples = np.abs(np.random.default_rng(2).normal(0.0, 0.03, 2000))
    samples[::20] += 1.0
    late = {"samples": samples, "drops": 0.05, "scatter": 0.03, "constant": 0.9, "per_tick": 0.0}
    drops, jitter = found(**late).causes
    assert (drops.effect, jitter.effect) == ("dropped_commands", "command_jitter")
    assert jitter.parameters["sigma"].value == pytest.approx(0.03 * PERIOD, rel=0.05)
    assert drops.closure.value + jitter.closure.value == pytest.approx(1.0)
    assert found(**late).closure.value == 1.0
    result = found(("command_jitter",), **late)
    assert [c.effect for c in result.causes] == ["dropped_commands"]
    assert result.closure.value == 0.0


def test_an_axis_is_late_beside_drops():
    samples = np.concatenate([np.zeros(490), np.ones(10)])
    facts = {"latency": np.array([0.0, 0.3, 0.0, 0.0, 0.0]), "samples": samples, "drops": 0.02, "apart": 0.9}
    causes = found(constant=0.95, per_tick=0.0, **facts).causes
    assert [(c.effect, c.actuator) for c in causes] == [("dropped_commands", "all"), ("axis_skew", "delta_2")]


def test_a_single_late_axis_is_where_its_lateness_sits():
    facts = {"alone": 4, "latency": np.array([0.0, 0.0, 0.0, 0.0, 0.6]), "samples": np.full(500, 0.6)}
    result = found(constant=0.0, per_tick=0.0, **facts)
    assert result.where.actuator == "tilt"
    assert [(c.effect, c.actuator) for c in result.causes] == [("axis_skew", "tilt")]


def test_the_gap_is_the_rms_of_the_echo_error_in_units_of_the_axes():
    result = found(energy=5000.0)
    top = np.median([a.limits.velocity for a in ROBOT.actuators])
    assert result.where.gap == pytest.approx(top)  # an energy of one per axis and tick
    assert result.where.confidence == 1.0
