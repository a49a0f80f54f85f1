"""A description of an arm drafted from a log and its model."""

import numpy as np
import pytest
from lifts import URDF, friction, motion, needed
from sher3_chain.manipulator.draft import draft_arm, fitted
from sher3_common import parse_yaml
from sher3_diagnosis import diagnose
from sher3_machines import MachineError, import_case, open_case

Q, V, A = motion(16.0)
TIME = np.arange(len(Q)) * 0.005
EFFORT = needed(Q, V, A) + friction(V, (8.0, 0.5)) + 0.02 * np.random.default_rng(1).normal(size=Q.shape)


def drafted(tmp_path, names):
    (tmp_path / "lift.urdf").write_text(URDF)
    rows = np.column_stack([TIME, Q, EFFORT])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header=",".join(names), comments="", fmt="%.9g")
    return draft_arm(tmp_path / "a.csv", tmp_path / "lift.urdf")


def test_a_drafted_arm_is_diagnosed(tmp_path):
    found = drafted(tmp_path, ["t", "q1", "q2", "tau1", "tau2"])
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
    verdict = diagnose(*open_case(tmp_path / "case")).verdict
    assert {(c.effect, c.actuator) for c in verdict.causes} == {
        ("coulomb_friction", "lift"),
        ("coulomb_friction", "swing"),
    }
    assert "joint1 is joint lift, because of its number" in found.guesses
    assert not any("mass is not known" in guess or "driven by" in guess for guess in found.guesses)


def test_matrices_are_the_joints_of_an_arm(tmp_path):
    """Names in the plural, a row for each sample: nothing is left out, speeds are kept for the clock."""
    (tmp_path / "lift.urdf").write_text(URDF)
    np.savez(tmp_path / "a.npz", times=TIME, positions=Q, velocities=V, torques=EFFORT)
    found = draft_arm(tmp_path / "a.npz", tmp_path / "lift.urdf")
    assert not any("not used" in guess for guess in found.guesses)
    assert found.text.count("column: torques") == found.text.count("column: velocities") == 2


def test_a_joint_that_is_held_is_recorded_where_it_is(tmp_path):
    (tmp_path / "lift.urdf").write_text(URDF)
    held = np.column_stack([Q[:, 0], np.full(len(Q), 0.4)])
    np.savez(tmp_path / "a.npz", time=TIME, q=held, tau=EFFORT)
    found = draft_arm(tmp_path / "a.npz", tmp_path / "lift.urdf")
    assert found.text.count("column: q") == 2 and not any("stay at zero" in guess for guess in found.guesses)


def test_references_alone_ask_for_the_gains_of_the_servo(tmp_path):
    (tmp_path / "lift.urdf").write_text(URDF)
    np.savez(tmp_path / "a.npz", time=TIME, q=Q, q_des=Q + 0.01)
    found = draft_arm(tmp_path / "a.npz", tmp_path / "lift.urdf")
    assert any("position_gain" in guess and "lift, swing" in guess for guess in found.guesses)
    data = parse_yaml(found.text)
    assert (data["kind"], [axis["name"] for axis in data["axes"]]) == ("axes", ["lift", "swing"])
    assert {axis["command_law"]["kind"] for axis in data["axes"]} == {"position"}


def test_a_current_has_an_unknown_gain(tmp_path):
    found = drafted(tmp_path, ["t", "lift_pos", "swing_pos", "lift_current", "swing_torque_Nm"])
    assert found.text.count("gain: unknown") == 1
    assert any(guess.startswith("lift: gain unknown") for guess in found.guesses)


@pytest.mark.parametrize("newton", [6.0, 10.0, 14.0])
def test_efforts_of_a_joint_state_that_are_currents_are_refused_and_judged_as_the_draft_says(tmp_path, newton):
    """A driver writes amperes of `newton` N (N m) each where torques belong: in newtons nothing fits the model."""
    (tmp_path / "lift.urdf").write_text(URDF)
    names = ["stamp", *(f"joint_states/{j}/{x}" for x in ("position", "effort") for j in ("lift", "swing"))]
    rows = np.column_stack([TIME, Q, EFFORT / newton])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header=",".join(names), comments="", fmt="%.9g")
    found = draft_arm(tmp_path / "a.csv", tmp_path / "lift.urdf")
    assert sum("writes currents" in guess and "`gain: unknown`" in guess for guess in found.guesses) == 2
    for text in (found.text, found.text.replace("motion:", "gain: unknown\n  motion:")):
        (tmp_path / "a.yaml").write_text(text, encoding="utf-8")
        import_case([tmp_path / "a.csv"], tmp_path / "a.yaml", tmp_path / "case")
        if text == found.text:
            with pytest.raises(MachineError, match=r"this many times what the model needs.*`gain: unknown`"):
                diagnose(*open_case(tmp_path / "case"))
    causes = diagnose(*open_case(tmp_path / "case")).verdict.causes
    dry = {c.actuator: c.parameters["force"] for c in causes if c.effect == "coulomb_friction"}
    assert {j: (x.value, x.unit) for j, x in dry.items()} == {
        "lift": (pytest.approx(8.0 / newton, rel=0.02), "eu"),
        "swing": (pytest.approx(0.5 / newton, rel=0.02), "eu"),
    }


def test_axes_are_joints_by_name_by_number_or_in_their_order(tmp_path):
    model = tmp_path / "a.urdf"
    joints = [f"arm_joint_{i}" for i in range(1, 4)]
    assert fitted(["arm_joint_2", "armjoint1"], joints, model)["armjoint1"] == ("arm_joint_1", "name")
    assert fitted(["q_3", "q_1"], joints, model) == {"q_3": (joints[2], "number"), "q_1": (joints[0], "number")}
    assert fitted(["q0", "q2", "q1"], ["a", "b", "c"], model)["q2"] == ("c", "number")
    assert fitted(["pan", "lift", "roll"], joints, model)["lift"] == (joints[1], "order")
    with pytest.raises(MachineError, match="do not fit"):
        fitted(["pan", "lift"], joints, model)


def test_numbered_columns_are_the_longest_chain_of_joints(tmp_path):
    """A hand's fingers have numbers of their own, numbers may begin at 0 or 1, and may stand within a name."""
    model = tmp_path / "a.urdf"
    fingers = ["panda_finger_joint1", "panda_finger_joint2"]
    arm = [f"panda_joint{i}" for i in range(1, 8)]
    for joints in ([*fingers, *arm], [*arm, *fingers]):
        for first in (0, 1):
            columns = [f"q{i + first}" for i in range(7)]
            assert [joint for joint, _ in fitted(columns, joints, model).values()] == arm
    assert fitted(["q1", "q2"], ["lwr_0_joint", "lwr_1_joint", "grip"], model)["q2"] == ("lwr_1_joint", "number")
    two = [f"{side}_joint{i}" for side in ("left", "right") for i in range(3)]
    with pytest.raises(MachineError, match="do not fit"):
        fitted(["q0", "q1", "q2"], two, model)


@pytest.mark.parametrize("blocks", ["qvat", "qvt", "tqv", "qtv"])
def test_a_table_without_names_is_blocks_of_the_joints(tmp_path, blocks):
    (tmp_path / "lift.urdf").write_text(URDF)
    parts = {"q": Q, "v": V, "a": A, "t": EFFORT}
    np.savetxt(tmp_path / "a.csv", np.column_stack([parts[b] for b in blocks]), delimiter=",", fmt="%.9g")
    joints = parse_yaml(draft_arm(tmp_path / "a.csv", tmp_path / "lift.urdf", rate=200.0).text)["joints"]
    at = {"position": blocks.index("q"), "velocity": blocks.index("v"), "effort": blocks.index("t")}
    for i, joint in enumerate(joints):
        assert {k: x["column"] for k, x in joint["signals"].items()} == {k: f"c{2 * n + i}" for k, n in at.items()}


@pytest.mark.parametrize(("place", "force"), [("dataQ", "dataTau"), ("joint_pos_read", "joint_torque_read")])
def test_files_of_one_signal_each_are_the_joints_of_an_arm(tmp_path, place, force):
    """No file has a header, none is a csv, and one of five rows was polled twice: the clock loses it too."""
    (tmp_path / "lift.urdf").write_text(URDF)
    (tmp_path / "log").mkdir()
    rows = np.repeat(np.arange(len(Q)), np.where(np.arange(len(Q)) % 4 == 3, 2, 1))
    for name, x in {"stamps": np.arange(len(rows)) * 0.004, place: Q[rows], force: EFFORT[rows]}.items():
        np.savetxt(tmp_path / "log" / f"{name}.txt", x, fmt="%.9g")
    (tmp_path / "log" / "readme.txt").write_text("what was done\n")
    found = draft_arm(tmp_path / "log", tmp_path / "lift.urdf")
    (tmp_path / "a.yaml").write_text(found.text, encoding="utf-8")
    import_case([tmp_path / "log"], tmp_path / "a.yaml", tmp_path / "case")
    _, (run,) = open_case(tmp_path / "case")
    assert set(run.signals) == {"lift", "swing"} and all(set(x) == {"position", "effort"} for x in run.signals.values())
    assert any("polled twice" in note for note in run.notes)
