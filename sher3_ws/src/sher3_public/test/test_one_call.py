"""A robot with more friction than its model, given in every form a person may have it."""

import subprocess
import sys
import tempfile

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import logged
from sher3_machines.errors import MachineError


def right(answer):
    (cause,) = answer.causes
    found = cause.parameters["force"].value
    return (cause.effect, cause.actuator) == ("coulomb_friction", "shoulder") and abs(found / 1.2 - 1.0) < 0.05


def test_control_and_position_are_enough(answer):
    assert right(answer)
    assert any("no effort was recorded" in guess for guess in answer.guessed)


@pytest.mark.parametrize("form", ["path", "text", "MjModel", "MjSpec"])
def test_a_model_in_any_form(form, log, tmp_path):
    (tmp_path / "arm.xml").write_text(log.xml)
    model = {
        "path": tmp_path / "arm.xml",
        "text": log.xml,
        "MjModel": mujoco.MjModel.from_xml_string(log.xml),
        "MjSpec": mujoco.MjSpec.from_string(log.xml),
    }[form]
    assert right(gap.diagnose(model, log.time, log.ctrl, log.qpos, log.actuator_force * gears(log)))


def gears(log):
    return mujoco.MjModel.from_xml_string(log.xml).actuator_gear[:, 0]


def test_a_table_with_names(log):
    table = {"time": log.time, "qpos": log.qpos, "ctrl": log.ctrl, "robot": np.array(["arm"] * len(log.time))}
    assert right(gap.diagnose(log.xml, table))


def test_logs_by_their_paths(log, tmp_path):
    """One path, a text or a `Path`, or several of one kind of record."""
    np.savez(tmp_path / "a.npz", time=log.time, qpos=log.qpos, ctrl=log.ctrl)
    assert right(gap.diagnose(log.xml, str(tmp_path / "a.npz")))
    two = gap.diagnose(log.xml, [tmp_path / "a.npz", tmp_path / "a.npz"])
    assert right(two) and len(two.case.runs) == 2
    with pytest.raises(ValueError, match=r"none\.csv: no such file"):
        gap.diagnose(log.xml, tmp_path / "none.csv")


class Frame:
    """What a frame of pandas or Polars has and the diagnosis uses: names of columns, columns by name, and an index."""

    def __init__(self, columns, index=()):
        self.data, self.columns, self.index = columns, list(columns), index

    def __getitem__(self, name):
        return self.data[name]


def test_frames_of_numbered_columns_as_runs_with_tags_for_each(log):
    frames = []
    for run in (logged(log.xml, 8), log):
        numbered = {f"{name}_{i}": x[:, i] for name, x in (("qpos", run.qpos), ("ctrl", run.ctrl)) for i in (0, 1)}
        frames.append(Frame({"time": run.time, **numbered}))
    answer = gap.diagnose(log.xml, frames, tags=[{"day": "first"}, {"day": "second"}])
    cause = answer.causes[0]
    assert (cause.effect, cause.actuator, cause.condition) == ("coulomb_friction", "shoulder", "day second")


@pytest.mark.parametrize("kind", ["seconds", "spans", "moments", "counts"])
def test_the_index_of_a_frame_is_its_time(log, kind):
    """Moments in a column of their own are it, too; a count of rows is none. A column may hold numbers as objects."""
    spans = np.round(1e9 * log.time).astype("timedelta64[ns]")
    index = {"seconds": log.time, "spans": spans, "moments": np.datetime64("2026-01-01") + spans}
    numbered = {
        f"{name}_{i}": x[:, i].astype(object) for name, x in (("qpos", log.qpos), ("ctrl", log.ctrl)) for i in (0, 1)
    }
    if kind == "counts":
        with pytest.raises(MachineError, match="no column looks like a time"):
            gap.diagnose(log.xml, Frame(numbered, np.arange(len(log.time))))
        numbered["time"] = index["moments"]
    assert right(gap.diagnose(log.xml, Frame(numbered, index.get(kind, np.arange(len(log.time))))))


def test_a_simulator_s_own_effort_is_told_from_a_measured_one(log):
    effort = log.actuator_force * gears(log)
    assert any("simulator's own" in g for g in gap.diagnose(log.xml, log.time, log.ctrl, log.qpos, effort).guessed)
    noisy = 1.3 * effort
    assert any("are measured" in g for g in gap.diagnose(log.xml, log.time, log.ctrl, log.qpos, noisy).guessed)


def test_several_runs_with_tags(log):
    healthy = logged(log.xml, 8)
    runs = [[x.time, x.ctrl, x.qpos] for x in (healthy, log)]
    time, control, position = (list(x) for x in zip(*runs, strict=True))
    answer = gap.diagnose(log.xml, time, control, position, tags={"day": ["first", "second"]})
    cause = answer.causes[0]
    assert (cause.effect, cause.actuator, cause.condition) == ("coulomb_friction", "shoulder", "day second")
    assert cause.parameters["force"].value == pytest.approx(1.2, rel=0.05)


def test_a_urdf_needs_efforts(log, tmp_path):
    urdf = (
        '<robot name="a"><link name="base"/><link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>'
        '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint></robot>'
    )
    inertia = 0.01 + 2 * 0.2**2
    speed = np.gradient(log.qpos[:, 0], log.time)
    effort = inertia * np.gradient(speed, log.time) + 0.7 * np.tanh(speed / 1e-3)
    (tmp_path / "arm.urdf").write_text(urdf)
    assert gap.diagnose(tmp_path / "arm.urdf", log.time, None, log.qpos[:, 0], effort).status == "attributed"
    answer = gap.diagnose(urdf, log.time, log.ctrl[:, 0], log.qpos[:, 0], effort)
    assert [(c.effect, c.actuator) for c in answer.causes] == [("coulomb_friction", "turn")]
    assert "turn: its control is not used, because the model has no drives; servo=(kp, kv)" in answer.guessed


def test_a_description_of_any_kind():
    time = np.arange(0.0, 12.0, 0.002)
    place = 0.04 * np.sin(1.3 * time) + 0.015 * np.sin(4.1 * time)
    speed = np.gradient(place, time)
    force = 3.0 * np.gradient(speed, time) + 2.0 * np.tanh(speed / 1e-3)
    signals = {"position": {"column": "x", "unit": "m"}, "effort": {"column": "f", "unit": "N"}}
    axis = {"name": "slide", "motion": "linear", "signals": signals, "command_law": {"kind": "none"}, "mass": 3.0}
    axes = [{**axis, "encoder_resolution": 1e-6}]
    described = {"kind": "axes", "name": "slide", "time": {"column": "t"}, "axes": axes}
    answer = gap.diagnose(
        described, {"t": time, "x": place, "f": force + 0.02 * np.random.default_rng(1).normal(size=6000)}
    )
    assert [c.effect for c in answer.causes] == ["coulomb_friction"]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"position": np.zeros((50, 3))}, "differ in length"),
        ({"position": None}, "position is missing"),
        ({"control": np.zeros((9, 2))}, "control and time differ in length"),
        ({"joints": ["a", "b"]}, "joints do not fit"),
        ({"model": 3}, "no known kind"),
        ({"model": "nowhere.xml"}, "cannot be read"),
        ({"time": [np.arange(50.0), np.arange(50.0)]}, "number of runs"),
        ({"tags": {"day": ["a", "b"]}}, "one value for each run"),
    ],
)
def test_wrong_input_is_named(change, words, log):
    given = {"model": log.xml, "time": log.time, "control": log.ctrl, "position": log.qpos}
    with pytest.raises(gap.InputError, match=words):
        gap.diagnose(**{**given, **change})


def test_nothing_is_written(log, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    before = gap.diagnose(log.xml, log.time, log.ctrl, log.qpos)
    print(before, before.report()[:10], before._repr_html_()[:10], before.corrected())
    assert not list(tmp_path.iterdir())


def test_importing_costs_a_face():
    script = (
        "import sys, time; t = time.process_time(); import sher3.gap; "
        "print(time.process_time() - t, 'numpy' in sys.modules)"
    )
    seconds, heavy = subprocess.check_output([sys.executable, "-c", script], text=True).split()
    assert heavy == "False" and float(seconds) < 0.3
