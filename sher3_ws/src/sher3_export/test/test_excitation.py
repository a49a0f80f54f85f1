"""Designed motions of other machines: within their limits, from rest to rest, in the forms that people run."""

import lifts
import numpy as np
import pytest
import yaml
from sher3_export import ExportError
from sher3_export.excitation.design import Excitation, designed, is_driven
from sher3_export.excitation.forms import as_csv, as_trajectory, save
from sher3_export.excitation.fourier import Box, Fourier, drawn, within

BOX = Box(np.array([-1.0, 0.0]), np.array([2.0, 0.5]), np.array([1.0, 0.2]), np.array([2.0, 0.1]))
T = np.linspace(0.0, 10.0, 2001)


def made():
    motion = within(drawn(np.random.default_rng(3), 2, 5, 10.0), BOX, T)
    return Excitation(["swing", "lift"], [False, True], motion, 0.2, 0.1, BOX)


def test_the_series_is_what_its_coefficients_say():
    """One second, sin(2 pi t) about 1: after a quarter at 2, at rest, and 4 pi^2 backwards."""
    one = Fourier(1.0, np.array([1.0]), np.array([[1.0]]), np.array([[0.0]]))
    q, v, a = (x[0, 0] for x in one.motion(np.array([0.25])))
    assert (q, v, a) == pytest.approx((2.0, 0.0, -4.0 * np.pi**2), abs=1e-9)


def test_a_motion_begins_and_ends_at_rest_and_meets_a_limit_of_every_joint():
    q, v, a = made().motion.motion(T)
    assert np.abs(v[[0, -1]]).max() < 1e-9 and np.abs(a[[0, -1]]).max() < 1e-9
    used = np.stack([np.ptp(q, axis=0) / (BOX.high - BOX.low), np.abs(v).max(0) / BOX.speed, np.abs(a).max(0) / BOX[3]])
    assert used.max(axis=0) == pytest.approx(1.0)
    assert (q >= BOX.low - 1e-9).all() and (q <= BOX.high + 1e-9).all()


def test_the_forms_hold_the_same_motion(tmp_path):
    q = made().motion.motion(made().time)[0]
    rows = np.genfromtxt(as_csv(made()).splitlines(), delimiter=",", names=True, deletechars="")
    assert "lift_velocity_[m/s]" in rows.dtype.names and rows["swing_position_[rad]"] == pytest.approx(
        q[:, 0], abs=1e-7
    )
    told = yaml.safe_load(as_trajectory(made()))
    assert told["joint_names"] == ["swing", "lift"] and len(told["points"]) == len(q)
    assert told["points"][150]["time_from_start"] == {"sec": 1, "nanosec": 500_000_000}
    assert told["points"][150]["positions"] == pytest.approx(q[150], abs=1e-7)
    with pytest.raises(ExportError, match="no such form"):
        save(tmp_path / "a.bag", made())


def test_mujoco_reads_the_controls(tmp_path):
    mujoco = pytest.importorskip("mujoco")
    save(tmp_path / "excitation.xml", made())
    (tmp_path / "arm.xml").write_text(
        """<mujoco><include file="excitation.xml"/><worldbody><body><joint name="swing" type="hinge"/>
        <geom size="0.1"/><body><joint name="lift" type="slide"/><geom size="0.1"/></body></body></worldbody>
        <actuator><position joint="swing"/><position joint="lift"/></actuator></mujoco>"""
    )
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    assert model.key_ctrl == pytest.approx(made().motion.motion(made().time)[0], abs=1e-7)


def test_an_arm_gets_a_better_motion_than_most_within_what_it_did(tmp_path):
    q, v, a = lifts.motion()
    arm = lifts.machine(tmp_path / "lift.urdf")
    found = designed(arm, [lifts.run_of(q, lifts.needed(q, v, a))])
    moved, speed, pull = found.motion.motion(found.time)
    assert list(found.joints) == ["lift", "swing"] and found.worst > 1.1 * found.median > 0.0
    assert (moved >= q.min(axis=0)).all() and (moved <= q.max(axis=0)).all()
    assert (np.abs(speed).max(axis=0) <= np.abs(v).max(axis=0)).all()
    assert (np.abs(pull).max(axis=0) <= 1.02 * np.abs(a).max(axis=0)).all()


def test_only_what_is_driven_is_given_a_motion(tmp_path):
    assert is_driven(lifts.machine(tmp_path / "lift.urdf")) and not is_driven(object())
