"""Gap over floor, by hand: powers over their thresholds, components judged together, encoder zeros."""

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel, Residual
from sher3_diagnosis.evidence import Evidence
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.localise.gaps import component_rms, gap_of, localise
from sher3_diagnosis.thresholds import FLOOR_SCATTER, GROUPED, POOLED, ZERO_COUNTS
from toy import AXIS, ToyRun, evidence_of

TIP = Channel("mechanism", "tip")
ENCODERS = Channel("transmission", "axis")


def run(excitation, values):
    values = np.array(values, dtype=float)
    return ToyRun(excitation, values, np.zeros(len(values)), np.ones(len(values)))


def of(channel, per_run, floor, excitations, **facts):
    residuals = [{channel: x} for x in per_run]
    data = Standardised([None] * len(per_run), residuals, [{channel: np.array(floor)} for _ in per_run])
    return Evidence(excitations=excitations, data=data, units={channel: "m"}, places={}, **facts)


def test_power_is_the_mean_square_over_the_floor_and_its_threshold():
    """Two repeats at 2 floors: power 4 pooled; one degree of freedom raises the threshold by half."""
    gap = gap_of(evidence_of([run("a", [2.0, -2.0]), run("a", [2.0, -2.0])]), AXIS)
    rise = 1.0 + FLOOR_SCATTER
    assert gap.power == pytest.approx(max(4.0 / (rise * POOLED["motor_mechanics"]), 4.0 / (rise * GROUPED)))
    assert (gap.ratio, gap.gap, gap.floor) == (pytest.approx(2.0), pytest.approx(2.0), pytest.approx(1.0))
    assert gap.significant
    assert gap.groups == {"a": pytest.approx(4.0)}


def test_one_excitation_alone_can_show_a_gap_that_all_together_hide():
    """Nine runs at their floor and one excitation at 3 floors: pooled 1.8, grouped 9."""
    runs = [run(str(k // 2), [1.0, -1.0]) for k in range(18)] + [run("odd", [3.0, -3.0]), run("odd", [3.0, -3.0])]
    gap = gap_of(evidence_of(runs), AXIS)
    assert gap.groups["odd"] == pytest.approx(9.0)
    assert gap.power == pytest.approx(9.0 / ((1.0 + FLOOR_SCATTER / 10) * GROUPED))


def test_a_channel_at_its_floor_has_no_gap():
    assert not gap_of(evidence_of([run("a", [1.0, -1.0]), run("a", [-1.0, 1.0])]), AXIS).significant
    assert gap_of(evidence_of([run("a", [1.0])]), TIP) is None


def test_a_gap_is_of_the_component_with_the_largest_ratio_in_its_own_unit():
    """Rotation is at 3, 4 and 2 floors, position at one: the gap is that about y, in rad."""
    values = np.tile([1.0, 1.0, 1.0, 0.3, 0.4, 0.2], (3, 1))
    residual = Residual(values, np.ones(3, dtype=bool))
    evidence = of(TIP, [residual, residual], [1.0] * 3 + [0.1] * 3, ["a", "a"])
    gap = gap_of(evidence, TIP)
    assert (gap.component, gap.gap, gap.floor) == (4, pytest.approx(0.4), pytest.approx(0.1))
    assert gap.ratio == pytest.approx(4.0)
    assert (evidence.component(TIP, 4), evidence.unit(TIP, gap.component)) == ("ry", "rad")
    assert component_rms({0: values, 1: 3.0 * values}, 4) == pytest.approx(0.4 * np.sqrt(5.0))


def test_the_zeros_of_two_encoders_may_differ_by_a_share_of_a_count():
    """Means of 1 count, 0.96 of it taken off: what is left would be no gap, the mean itself is 1 / ZERO_COUNTS."""
    residual = Residual(np.full((50, 1), 1.0), np.ones(50, dtype=bool), free_mean=0.96)
    gap = gap_of(of(ENCODERS, [residual, residual], [0.5], ["a", "a"], counts={"axis": 1.0}), ENCODERS)
    assert gap.power == pytest.approx(1.0 / ZERO_COUNTS**2)
    assert (gap.gap, gap.floor) == (pytest.approx(1.0), pytest.approx(ZERO_COUNTS / 3.0))
    unknown = gap_of(of(ENCODERS, [residual, residual], [0.5], ["a", "a"]), ENCODERS)
    assert unknown.power < 0.01


def test_the_most_significant_gap_comes_first():
    other = Channel("drive", "axis")
    residual = {AXIS: Residual(np.full((4, 1), 2.0), np.ones(4, dtype=bool))}
    residual[other] = Residual(np.full((4, 1), 5.0), np.ones(4, dtype=bool))
    data = Standardised([None], [residual], [{AXIS: np.ones(1), other: np.ones(1)}])
    evidence = Evidence(excitations=["a"], data=data, units={AXIS: "N", other: "N"}, places={})
    assert [g.channel for g in localise(evidence)] == [other, AXIS]
