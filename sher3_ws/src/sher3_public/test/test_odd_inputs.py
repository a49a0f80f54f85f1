"""What people give at their first try: answered, or refused with what to do."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from sher3_machines.errors import MachineError
from sher3_public.errors import InputError

ARM = """<mujoco><option timestep="0.002" integrator="implicitfast"/><worldbody><body pos="0 0 0.5">
<joint name="shoulder" axis="0 1 0" damping="0.5" armature="0.02"/>
<geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="2"/><body pos="0.4 0 0">
<joint name="elbow" axis="0 1 0" damping="0.2" armature="0.01"/>
<geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.025" mass="1"/></body></body></worldbody>{rest}</mujoco>"""
SERVOS = '<position joint="shoulder" kp="400" kv="20"/><position joint="elbow" kp="200" kv="8"/>'
MODEL = ARM.format(rest=f"<actuator>{SERVOS}</actuator>")
MOTORS = ARM.format(rest='<actuator><motor joint="shoulder"/><motor joint="elbow"/></actuator>')
TENDON = ARM.format(
    rest='<tendon><fixed name="belt"><joint joint="shoulder" coef="1"/><joint joint="elbow" coef="1"/></fixed></tendon>'
    '<actuator><position joint="shoulder" kp="400"/><position name="pull" tendon="belt" kp="200"/></actuator>',
)


@pytest.fixture(scope="module")
def log():
    """Stamps (n,), controls and positions (n, 2) of an arm whose elbow has 1.2 N m more dry friction."""
    robot, rows = mujoco.MjModel.from_xml_string(MODEL), []
    robot.dof_frictionloss[1] += 1.2
    data = mujoco.MjData(robot)
    for _ in range(6000):
        t = data.time
        data.ctrl[:] = [0.6 * np.sin(1.7 * t) + 0.3 * np.sin(4.1 * t), 0.7 * np.sin(2.3 * t) + 0.2 * np.sin(5.3 * t)]
        mujoco.mj_forward(robot, data)
        rows.append([t, *data.ctrl, *data.qpos])
        mujoco.mj_step(robot, data)
    time, control, position = np.split(np.array(rows), [1, 3], axis=1)
    return time[:, 0], control, position + 1e-5 * np.random.default_rng(1).normal(size=position.shape)


def named(answer):
    return {(c.effect, c.actuator) for c in answer.causes}


def test_positions_that_come_at_every_fifth_stamp(log):
    time, control, position = log
    sparse = np.where(np.arange(len(time))[:, None] % 5 == 0, position, np.nan)
    assert named(gap.diagnose(MODEL, time, control, sparse)) == {("coulomb_friction", "elbow")}


def test_one_joint_alone_of_a_model_in_mjcf(log):
    """The shoulder is taken to be at rest: the elbow is judged, and the answer says what was assumed."""
    time, control, position = log
    still = gap.diagnose(MODEL, time, control[:, 1], position[:, 1], joints="elbow")
    assert ("coulomb_friction", "elbow") in named(still)
    assert any("stay at zero: shoulder" in guess for guess in still.guessed)


NOTHING = ARM.format(rest="")
ON_A_BASE = '<body pos="0 0 0.5"><{joint}/><geom size=".1" mass="5"/><body>'


def on(joint):
    """The arm on a body with a joint of its own."""
    text = MODEL.replace('<body pos="0 0 0.5">', ON_A_BASE.format(joint=joint), 1)
    return text.replace("</worldbody>", "</body></worldbody>")


@pytest.mark.parametrize(
    ("model", "words"),
    [
        (NOTHING, "its control is not used, because the model has no actuator on it"),
        (TENDON, "actuator pull moves it by a tendon"),
        (on("freejoint"), "take its freejoint out"),
        (on('joint type="ball"'), "three hinges"),
    ],
    ids=["no actuators", "tendon", "free base", "ball joint"],
)
def test_a_model_that_cannot_be_judged_is_refused_with_the_reason(log, model, words):
    with pytest.raises(MachineError) as caught:
        gap.diagnose(model, *log)
    assert words in str(caught.value)


def test_units_that_cannot_be(log):
    time, control, position = log
    with pytest.raises(InputError, match="in ms by 1000"):
        gap.diagnose(MODEL, 1e3 * time, control, position)
    with pytest.raises(InputError, match="likely in degrees"):
        gap.diagnose(MODEL, time, np.degrees(control), np.degrees(position))


def test_a_handful_of_samples_is_said(log):
    with pytest.raises(InputError, match="too few samples; value 10; limit 20"):
        gap.diagnose(MODEL, *(x[:10] for x in log))


def test_a_column_that_lost_its_last_rows_and_a_gain_that_is_none(log):
    time, control, position = log
    with pytest.raises(InputError, match="ctrl and time differ in length; value 5998; limit 6000"):
        gap.diagnose(MODEL, {"time": time, "ctrl": control[:-2], "qpos": position})
    with pytest.raises(MachineError, match=r"joints\.0\.gain.*value large"):
        gap.diagnose(MODEL, time, None, position, position, gain="large")


@pytest.mark.parametrize("lost", ["positions", "one position", "one control", "whole rows"])
def test_rows_of_nan_part_a_record(log, lost):
    time, control, position = (x.copy() for x in log)
    one = {"one position": (position[:, 1],), "one control": (control[:, 0],), "positions": (position,)}
    for x in one.get(lost, (time, control, position)):
        x[2000:2300] = np.nan
    answer = gap.diagnose(MODEL, time, control, position)
    assert named(answer) == {("coulomb_friction", "elbow")}
    assert any("cut into 2 parts, because it has holes; 300 samples" in note for note in answer.notes)


def test_samples_one_by_one_a_structured_array_and_names_in_two_levels(log):
    """As `to_dict("records")`, `to_records()` and a frame with a MultiIndex hold them."""
    names = [
        ("time", ""),
        ("position", "shoulder"),
        ("position", "elbow"),
        ("command", "shoulder"),
        ("command", "elbow"),
    ]
    columns = [log[0], *log[2].T, *log[1].T]
    plain = ["_".join(x for x in name if x) for name in names]
    rows = [dict(zip(plain, map(float, row), strict=True)) for row in np.column_stack(columns)]
    for table in (rows, np.rec.fromarrays(columns, names=",".join(plain)), dict(zip(names, columns, strict=True))):
        assert named(gap.diagnose(MODEL, table)) == {("coulomb_friction", "elbow")}


def test_no_gap_says_which_joint_was_not_judged(log):
    """An actuator with a filter of its own: its force does not follow from its control."""
    answer = gap.diagnose(MODEL.replace('kp="200" kv="8"', 'kp="200" kv="8" timeconst="0.03"'), *log)
    assert answer.headline.startswith("No gap where it was judged: ")
    assert answer.headline.endswith("; not judged, no usable effort or no motion: elbow.")


def test_a_compiled_model(log, tmp_path):
    mujoco.mj_saveModel(mujoco.MjModel.from_xml_string(MODEL), str(tmp_path / "robot.mjb"))
    answer = gap.diagnose(tmp_path / "robot.mjb", *log)
    assert named(answer) == {("coulomb_friction", "elbow")}
    with pytest.raises(InputError, match="an MjModel"):
        answer.corrected(to="mjcf")
    (tmp_path / "no.mjb").write_bytes(b"0")
    with pytest.raises(MachineError, match="give its XML, or a file that MuJoCo"):
        gap.diagnose(tmp_path / "no.mjb", *log)


def test_noise_that_hides_the_forces_is_no_unit(log):
    """In degrees all forces are smaller, those of the noise too: that speaks for no unit."""
    time, control, position = log
    noisy = 3.0 * position + 0.6 * np.random.default_rng(0).standard_normal(position.shape)
    assert "cannot be judged: what nobody can foresee" in str(gap.diagnose(MOTORS, time, 5.0 * control, noisy))


def test_a_control_that_is_no_place_and_one_that_is_no_force(log):
    time, control, position = log
    with pytest.raises(InputError, match="give it as effort="):
        gap.diagnose(MODEL, time, 300.0 * (control - position) + 5.0 * np.sin(7.0 * time)[:, None], position)
    with pytest.raises(InputError, match="a model with position actuators"):
        gap.diagnose(MOTORS, time, control, position)


def test_controls_without_numbers_and_one_that_never_changes(log):
    time, control, position = log
    no_number = (control > 0.0, control.astype(complex))
    for given, words in ((np.full_like(control, np.nan), "has no number"), *((x, "no array of n") for x in no_number)):
        with pytest.raises(InputError, match=words):
            gap.diagnose(MODEL, time, given, position)
    with pytest.raises(InputError, match="moves while no control changes"):
        gap.diagnose(MODEL, time, np.full_like(control, 0.1), position)


def test_columns_in_another_order(log):
    """Stated joints order both; where nothing is stated, servos that follow each other's control are refused."""
    time, control, position = log
    turned = gap.diagnose(MODEL, time, control[:, ::-1], position[:, ::-1], joints=["elbow", "shoulder"])
    assert named(turned) == {("coulomb_friction", "elbow")}
    assert any("in the order of `joints`" in guess for guess in turned.guessed)
    with pytest.raises(InputError, match="shoulder: its position follows the control of elbow"):
        gap.diagnose(MODEL, time, control, position[:, ::-1])


def test_stamps_as_numpy_has_times_and_in_nanoseconds(log):
    time, control, position = log
    nano = (1e9 * time).round().astype("timedelta64[ns]")
    for stamps in (nano, np.datetime64("2026-01-01") + nano):
        assert named(gap.diagnose(MODEL, stamps, control, position)) == {("coulomb_friction", "elbow")}
    with pytest.raises(MachineError, match="needs float64, not float32"):
        gap.diagnose(MODEL, (1.7e9 + time).astype(np.float32), control, position)
    with pytest.raises(InputError, match="in ns by 1000000000"):
        gap.diagnose(MODEL, nano.astype(float), control, position)
    with pytest.raises(InputError, match="time has no stamps"):
        gap.diagnose(MODEL, [], [], [])


def test_infinite_controls_are_no_controls_and_a_guess_counts_them(log):
    """MuJoCo would clip them to the actuator's range; a simulation that was told so has stopped."""
    time, control, position = log
    given = control.copy()
    given[::2, 0] = np.inf
    limited = MODEL.replace('kp="400"', 'kp="400" ctrlrange="-2 2"')
    verdict = gap.diagnose(limited, time, given, position)
    assert [(c.effect, c.actuator) for c in verdict.causes] == [("coulomb_friction", "elbow")]
    assert any("3000 of 12000 controls are infinite" in text for text in verdict.guessed)


def test_angles_in_degrees_beyond_the_model_s_range(log):
    time, control, position = log
    few = 0.5 * np.degrees(position)
    limited = MODEL.replace('name="shoulder"', 'name="shoulder" range="-150 150"')
    with pytest.raises(InputError, match=r"shoulder: position leaves the model's range; .* limit 2\.618; give angles"):
        gap.diagnose(limited, time, control, few)
    with pytest.raises(InputError, match="elbow: position has no number"):
        gap.diagnose(MODEL, time, control, position * [1.0, np.nan])


CUBE = '<body pos="1 1 1"><freejoint/><geom size=".02" contype="0" conaffinity="0"/></body><body pos="0 0 0.5">'


def test_a_whole_qpos_with_a_cube_in_it(log):
    time, control, position = log
    model = MODEL.replace('<body pos="0 0 0.5">', CUBE, 1)
    answer = gap.diagnose(model, time, control, np.column_stack([np.ones((len(time), 7)), position]))
    assert named(answer) == {("coulomb_friction", "elbow")}
    assert any("whole qpos" in guess for guess in answer.guessed)


def test_a_joint_that_an_equality_couples_is_not_judged(log):
    coupled = MODEL.replace("</mujoco>", '<equality><joint joint1="elbow"/></equality></mujoco>')
    assert any("an equality couples it" in guess for guess in gap.diagnose(coupled, *log).guessed)


def test_positions_that_drown_in_noise(log):
    time, control, position = log
    with pytest.raises(MachineError, match="record quieter positions"):
        gap.diagnose(MODEL, time, control, position + 0.6 * np.random.default_rng(0).normal(size=position.shape))


def test_a_record_that_is_too_short(log):
    with pytest.raises(MachineError, match="too little of the record is motion"):
        gap.diagnose(MODEL, *(x[:50] for x in log))
