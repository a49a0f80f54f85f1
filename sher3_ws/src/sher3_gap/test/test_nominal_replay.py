"""The nominal plant driven as a run was."""

from dataclasses import replace

import numpy as np
import pytest
from recorded import ROBOT, run, stroke
from sher3_gap.evidence import gather
from sher3_gap.nominal_replay import bridged, driven_as, first_alike, followed
from sher3_gap.simulate.tip import tip_error
from simulated import runs_of, signals


def test_a_run_without_set_points_has_no_twin_but_can_be_followed():
    signals = run(400, motor=stroke())
    assert driven_as(signals, ROBOT) is None
    own = followed(signals)
    assert own.reference == pytest.approx(signals.smooth)
    twin = driven_as(own, ROBOT)
    assert np.abs(twin.motor - signals.motor)[100:300].max() < 0.2 * np.abs(signals.motor).max()


def test_a_run_with_set_points_keeps_them():
    signals = run(400, reference=stroke(), reference_velocity=0.0)
    assert followed(signals) is signals


def test_a_load_is_bridged_by_a_straight_line_where_it_is_not_known():
    contact, known = np.zeros((5, 3)), np.array([True, False, False, True, True])
    contact[3:] = 3.0
    assert bridged(run(5, contact=contact, contact_known=known))[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 3.0]
    assert not bridged(run(5)).any()
    assert bridged(run(5, contact=contact)) is not None


def test_the_evidence_keeps_the_nominal_model_driven_as_each_run_was():
    runs = signals(runs_of(["steps"], repeats=2))
    for own, twin in zip(runs, gather(runs, ROBOT).twins, strict=True):
        assert np.array_equal(tip_error(own, twin), tip_error(own, driven_as(own, ROBOT)))


def test_repeats_have_one_twin_whatever_their_warmth():
    led = run(400, reference=stroke(), reference_velocity=np.zeros((400, 5)))
    warm = replace(led, temperature=np.full(400, 30.0))
    other, loaded = replace(led, reference=2.0 * led.reference), replace(led, contact=np.ones((400, 3)))
    free = run(400, motor=stroke())
    assert first_alike([led, other, warm, free, free, loaded]) == [0, 1, 0, 3, 4, 5]
