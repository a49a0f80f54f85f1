"""What a motion cannot tell apart, computed before any fit."""

import numpy as np
import pytest
from causes_at import caused
from lifts import machine, motion, needed, run_of
from sher3_chain.manipulator.causes.confounding import (
    beyond_motion,
    confounded,
    confounded_in,
    confounding_notes,
    in_step,
)


def test_columns_that_nearly_cancel_are_named():
    """Two columns alike but for a hundredth, a third one across them."""
    x = np.sin(np.linspace(0.0, 20.0, 500))
    y = np.cos(np.linspace(0.0, 20.0, 500))
    found = confounded({"a": x[:, None], "b": (x + 0.01 * y)[:, None], "c": y[:, None]})
    assert found == [frozenset("ab")]
    assert confounded({"a": x[:, None], "c": y[:, None]}) == []


@pytest.mark.parametrize(("pace", "together"), [(0.05, True), (3.0, False)])
def test_a_slow_pendulum_cannot_tell_its_gain_from_its_weight(tmp_path, pace, together):
    """Slowly moved, a pendulum is given its weight and nothing else; fast on a fast lift, it is given much more."""
    q, v, a = motion(40.0)
    run = run_of(q, needed(q, pace * v, pace**2 * a), period=0.005 / pace)
    arm = machine(tmp_path / "lift.urdf")
    evidence = arm.gather([run])[0]
    groups = [g for g in confounded_in(evidence, "swing") if {"drive gain", "weight"} <= g]
    assert bool(groups) == together


def test_a_lift_never_tells_a_constant_force_from_its_weight(tmp_path):
    q, v, a = motion()
    evidence = machine(tmp_path / "lift.urdf").gather([run_of(q, needed(q, v, a))])[0]
    assert any({"constant force", "weight"} <= group for group in confounded_in(evidence, "lift"))


def test_gain_against_weight_asks_for_a_known_weight_and_friction_does_not():
    causes = [
        caused("torque_constant", "scale", "A5", "relative", 0.45, "1", ["gravity_load", "stribeck_friction"]),
        caused("coulomb_friction", "friction", "A4", "force", 8.0, "N*m", ["gear_loss"]),
    ]
    (told,) = beyond_motion(causes)
    assert told.startswith("no motion tells torque constant and gravity load on A5 apart, a known weight does")


@pytest.mark.parametrize(("share", "together"), [(0.0, True), (0.02, True), (0.5, False)])
def test_joints_that_move_in_step_are_told(tmp_path, share, together):
    """Two joints on one motion, whatever the travel and the middle of each, with a share of a motion of its own."""
    t = np.arange(4000) * 0.005
    paces = np.array([1.3, 1.3]), np.array([1.3, 2.9])
    travel, middle = np.array([0.05, 0.7]), np.array([0.2, -0.4])
    each = [np.sin(p * t[:, None]) * w for p, w in zip(paces, (1.0 - share, share), strict=True)]
    q = middle + travel * sum(each)
    v = travel * sum(p * np.cos(p * t[:, None]) * w for p, w in zip(paces, (1.0 - share, share), strict=True))
    a = -travel * sum(p**2 * x for p, x in zip(paces, each, strict=True))
    evidence = machine(tmp_path / "lift.urdf").gather([run_of(q, needed(q, v, a))])[0]
    assert in_step(evidence) == together
    assert any("moved in step" in note for note in confounding_notes(evidence)) == together
