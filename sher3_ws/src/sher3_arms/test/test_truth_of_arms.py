"""The truth side: arms load, faults do in MuJoCo what they say, and a case gives nothing away."""

import mujoco
import numpy as np
import pytest
import yaml
from sher3_arms import ArmsError
from sher3_arms.truth import cases
from sher3_arms.truth.cases import seal
from sher3_arms.truth.faults import COMPOUND, HEALTHY, KINDS, ORDER, OUTSIDE, Fault, deal, passive
from sher3_arms.truth.robots import FILES, OWN, urdf_of
from sher3_arms.truth.world import inertias, inverse, load, motion, record

URDF = urdf_of(OWN)


def test_the_recorded_efforts_are_what_the_nominal_model_needs_on_a_healthy_arm():
    found = record(URDF, Fault(HEALTHY), 4.0, np.random.default_rng(1))
    model = load(URDF)
    _, q, v, a = motion(model, 4.0, np.random.default_rng(1))
    rms = np.sqrt(np.mean(inverse(model, q, v, a) ** 2, axis=0))
    assert np.sqrt(np.mean((found.position - q) ** 2, axis=0)) == pytest.approx(0.0, abs=1e-3)
    assert np.sqrt(np.mean(found.effort**2, axis=0)) == pytest.approx(rms, rel=0.02)


def test_friction_and_gain_show_in_the_efforts_by_their_size():
    model, rng = load(URDF), np.random.default_rng
    _, q, v, a = motion(model, 6.0, rng(1))
    need = inverse(model, q, v, a)
    late = slice(500, None)
    slow = record(URDF, Fault("coulomb", 1, 2.0), 6.0, rng(1)).effort - need
    moving = np.abs(v[late, 1]) > 0.1
    assert np.median((slow[late, 1] * np.sign(v[late, 1]))[moving]) == pytest.approx(2.0, rel=0.05)
    weak = record(URDF, Fault("gain", 1, -0.2), 6.0, rng(1)).effort
    assert np.median(weak[late, 1] / need[late, 1]) == pytest.approx(1.0 / 0.8, rel=0.05)  # the arm sags a little


def test_fields_of_mujoco_are_set():
    assert load(URDF, Fault("viscous", 2, 0.7)).dof_damping.tolist() == [0.0, 0.0, 0.7]
    assert load(URDF, Fault("armature", 0, 0.3)).dof_armature.tolist() == [0.3, 0.0, 0.0]
    spring = load(URDF, Fault("spring", 1, 5.0, {"reference": 0.2}))
    assert spring.qpos_spring[1] == 0.2
    whole = sum(load(URDF).body_mass)
    carried = load(URDF, Fault("payload", 2, 0.1, {"x": 0.0, "y": 0.0, "z": 0.05}))
    assert sum(carried.body_mass) == pytest.approx(1.1 * whole, rel=1e-6)


def test_faults_by_callback():
    state = (np.array([0.5, 0.0, 0.0]), np.array([0.0, 1.0, -1.0]), np.array([4.0, 4.0, 4.0]))
    assert passive(Fault("gear_loss", 1, 0.1), *state).tolist() == pytest.approx([0.0, -0.4, 0.0])
    assert passive(Fault("foreign_cable", 1, 2.0, {"from": 0.0}), *state)[1] == pytest.approx(-2.0 * np.tanh(1.5))
    assert not passive(Fault("coulomb", 1, 2.0), *state).any()


def test_a_second_joint_gives_way_by_its_size():
    """A spring of 2000 N m/rad gives what its torque over it is; a gap of 6 mrad gives its half."""
    rng = np.random.default_rng
    elastic = record(URDF, Fault("elastic", 1, 0.005, {"rotor": 0.02, "stiffness": 2000.0}), 6.0, rng(1))
    given = elastic.link[500:, 1] - elastic.position[500:, 1]
    assert np.polyfit(elastic.effort[500:, 1], given, 1)[0] == pytest.approx(-1.0 / 2000.0, rel=0.1)
    gap = record(URDF, Fault("backlash", 1, 0.006, {"rotor": 0.02}), 6.0, rng(1))
    assert np.abs(gap.link[500:, 1] - gap.position[500:, 1]).max() == pytest.approx(0.003, rel=0.15)
    assert np.array_equal(gap.link[:, 0], gap.position[:, 0])


def test_a_late_drive_and_a_late_reading_are_late_by_their_size():
    healthy = record(URDF, Fault(HEALTHY), 6.0, np.random.default_rng(1)).effort[:, 1]
    late = record(URDF, Fault("late_effort", 1, 0.016), 6.0, np.random.default_rng(1)).effort[:, 1]
    assert np.abs(late[504:] - healthy[500:-4]).max() < 0.02 * np.abs(healthy).max()
    drive = record(URDF, Fault("late_drive", 1, 0.016), 6.0, np.random.default_rng(1)).effort[:, 1]
    assert np.isfinite(drive).all() and np.abs(drive).max() < 2.0 * np.abs(healthy).max()


def test_every_kind_is_dealt():
    kinds = set(ORDER)
    assert len(ORDER) == 20
    assert kinds == {*KINDS, *OUTSIDE, COMPOUND, HEALTHY}
    for kind in kinds:
        fault = deal(np.random.default_rng(3), kind, np.ones(3), np.ones(3), np.ones(3))
        assert fault.kind == kind or (kind == COMPOUND and fault.second.joint != fault.joint)
        assert (fault.joint >= 0) == (kind != HEALTHY)


def test_a_sealed_case_gives_nothing_away(tmp_path):
    label = seal(3, [OWN], tmp_path / "case", 12.0)
    names = {path.name for path in (tmp_path / "case").iterdir()}
    assert names == {"record.npz", "model.urdf", "machine.yaml"}
    text = yaml.safe_load((tmp_path / "case/machine.yaml").read_text())
    assert label.fault.kind == "gain" and "gain" not in str(text)
    other = seal(3, [OWN], tmp_path / "again", 12.0)
    assert other == label


def test_a_fault_that_makes_the_arm_unstable_is_drawn_again(tmp_path, monkeypatch):
    """A drive that is late by 80 ms makes a loop of 40 rad/s unstable; one of 5 ms does not."""
    drawn = iter([0.08, 0.08, 0.005])
    monkeypatch.setattr(cases, "deal", lambda *_: Fault("late_drive", 1, next(drawn)))
    label = seal(0, [OWN], tmp_path / "case", 12.0, ["late_drive"])
    assert label.drawn == 3 and label.fault.size == 0.005
    assert np.isfinite(np.load(tmp_path / "case/record.npz")["position"]).all()
    monkeypatch.setattr(cases, "deal", lambda *_: Fault("late_drive", 1, 0.08))
    with pytest.raises(ArmsError, match="unstable with every late_drive"):
        seal(0, [OWN], tmp_path / "again", 12.0, ["late_drive"])


def test_a_gap_that_is_never_crossed_is_drawn_again(tmp_path, monkeypatch):
    """The weight of the lower arm holds its joint at one stop in this motion; nothing holds that of the turn."""
    drawn = iter([Fault("backlash", 2, 0.005, {"rotor": 0.003}), Fault("backlash", 0, 0.005, {"rotor": 0.02})])
    monkeypatch.setattr(cases, "deal", lambda *_: next(drawn))
    label = seal(929, [OWN], tmp_path / "case", 12.0, ["backlash"])
    assert label.drawn == 2 and label.fault.joint == 0


def test_an_arm_that_is_not_there_is_refused():
    with pytest.raises(ArmsError, match="no such arm"):
        urdf_of("atlas")


@pytest.mark.slow
@pytest.mark.parametrize("name", FILES)
def test_arms_of_the_wheel_load(name):
    """Needs the extra `arms`, 131 MB: without it the refusal names it."""
    try:
        text = urdf_of(name)
    except ArmsError as error:
        assert "extra `arms`" in str(error)
        return
    model = load(text)
    assert 5 <= model.nv <= 7 and (inertias(model, np.zeros(model.nv)) > 0.0).all()
    assert all(kind == mujoco.mjtJoint.mjJNT_HINGE for kind in model.jnt_type)
