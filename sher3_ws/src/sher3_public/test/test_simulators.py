"""Two traces of the same commands: settings of MuJoCo by replay, parameters by diagnosis, and what is no pair."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from sher3_public.records import columns_named

BOX = """<mujoco><option timestep="0.002"/><worldbody><geom type="plane" size="2 2 1"/><body pos="0 0 0.05">
<joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="0 0 1"/>
<geom type="box" size="0.1 0.1 0.05" mass="1"/></body></worldbody><actuator><motor joint="x"/></actuator></mujoco>"""


def pushed(options="", samples=400, substeps=1, speeds=False):
    """A box that is pushed to and fro on a plane, with options of MuJoCo in place of the model's."""
    model = mujoco.MjModel.from_xml_string(BOX.replace('timestep="0.002"', f'timestep="{0.002 / substeps}" {options}'))
    data, rows = mujoco.MjData(model), []
    data.qvel[0] = 0.2
    for k in range(samples):
        data.ctrl[:] = 12.0 * np.sin(0.006 * k)
        rows.append([0.002 * k, *data.ctrl, *data.qpos, *data.qvel])
        mujoco.mj_step(model, data, substeps)
    rows = np.array(rows)
    known = {"time": rows[:, 0], "ctrl": rows[:, 1:2], "qpos": rows[:, 2:4]}
    return {**known, "qvel": rows[:, 4:]} if speeds else known


@pytest.mark.parametrize(
    ("options", "substeps", "said"),
    [
        ('cone="elliptic"', 1, "friction cone elliptic"),
        ('integrator="RK4"', 1, "integrator RK4"),
        ("", 5, "time step 0.0004 s"),
    ],
)
def test_a_setting_is_named_with_contacts_too(options, substeps, said):
    speeds = substeps > 1
    found = gap.compare_simulators(pushed(speeds=speeds), pushed(options, substeps=substeps, speeds=speeds), BOX)
    assert found.settings == ("the model's own settings", said) and found.answer is None
    assert f"second has {said}" in str(found)


def test_late_commands_are_told_in_time_and_rows_of_another_log_too():
    """Two rows late; and a log that holds the position behind each step."""
    model = mujoco.MjModel.from_xml_string(BOX)
    first = pushed()
    late = {**first, "qpos": went(model, first["ctrl"][np.clip(np.arange(400) - 2, 0, 399)], speed=0.2)}
    assert gap.compare_simulators(first, late, BOX).settings[1] == "commands 4 ms late"
    behind = {name: x[:-1] if name != "qpos" else x[1:] for name, x in first.items()}
    ahead = {name: x[:-1] for name, x in first.items()}
    assert gap.compare_simulators(ahead, behind, BOX).settings[1] == "rows that were logged after their step"


def test_traces_that_are_alike_have_no_cause():
    found = gap.compare_simulators(pushed(), pushed(), BOX, names=("a", "b"))
    assert found.cause == "" and "b against a" in str(found) and "they are the same" in str(found)


def test_a_parameter_is_named_by_the_diagnosis(log, more):
    """Friction of `conftest.py` in the second one; no setting makes it."""
    first, second = mujoco.MjModel.from_xml_string(log.xml), mujoco.MjModel.from_xml_string(log.xml)
    second.dof_frictionloss[1] += more
    tables = [{"time": log.time, "ctrl": log.ctrl, "qpos": went(model, log.ctrl)} for model in (first, second)]
    found = gap.compare_simulators(*tables, log.xml, names=("ours", "theirs"))
    assert "Coulomb friction on shoulder" in found.cause and found.settings == ("", "")
    assert [c.condition for c in found.answer.causes] == ["simulator theirs"]


def went(model, controls, speed=0.0):
    data, rows = mujoco.MjData(model), []
    data.qvel[0] = speed
    for control in controls:
        data.ctrl[:] = control
        rows.append(data.qpos.copy())
        mujoco.mj_step(model, data)
    return np.array(rows)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"ctrl": np.zeros((400, 1))}, "commands differ"),
        ({"time": np.arange(400) * 0.003}, "stamps differ"),
        ({"qpos": np.zeros((400, 1))}, "positions differ in rows and columns"),
    ],
)
def test_what_is_no_pair_is_said(change, said):
    with pytest.raises(gap.InputError, match=said):
        gap.compare_simulators(pushed(), {**pushed(), **change}, BOX)
    with pytest.raises(gap.InputError, match="positions are missing"):
        gap.compare_simulators({"time": np.arange(9.0)}, {"time": np.arange(9.0)}, BOX)
    mute = {name: x for name, x in pushed().items() if name != "ctrl"}
    with pytest.raises(gap.InputError, match="commands are missing in the second trace"):
        gap.compare_simulators(pushed(), mute, BOX)


def test_numbered_columns_in_one_trace_and_one_array_in_the_other(log):
    first = {"time": log.time, "ctrl": log.ctrl, "qpos": log.qpos}
    loose = {f"{name}{i}": first[name][:, i] for name in ("ctrl", "qpos") for i in (0, 1)}
    loose["qpos1"] = loose["qpos1"] + 0.01
    found = gap.compare_simulators(first, {"time": log.time, **loose}, log.xml)
    assert found.apart == pytest.approx([0.0, 0.01]) and found.cause


def test_numbered_columns_are_put_in_order():
    table = {f"q_{i}": np.full(3, i) for i in (10, 2, 0)}
    assert columns_named(table, ("qpos", "q"))[0].tolist() == [0, 2, 10] and columns_named(table, ("x",)) is None


def test_a_model_in_the_place_of_a_trace_is_named():
    table = {"time": np.arange(30.0), "ctrl": np.zeros((30, 1)), "qpos": np.zeros((30, 1))}
    for given in ("<mujoco/>", np.zeros((30, 2))):
        with pytest.raises(gap.InputError, match="a trace is no table"):
            gap.compare_simulators(given, table, table)
