"""The exported model on recorded commands, and the motion that ranges cover."""

from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import tostring

import numpy as np
import pytest
from sher3_chain.axes.machine import Axes
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Interval
from sher3_export import ExportError, export
from sher3_export.check import check as checking
from sher3_export.check import coverage as covering
from sher3_export.check import engine
from sher3_export.check.check import Checked, JointGap, check
from sher3_export.check.coverage import DRAWS, Windows, covered, inside, scatter_of
from sher3_export.errors import MujocoMissing
from sher3_export.ranges import Ranges, interval, shares_of, worlds_of
from slides import MASS, columns, driven, machine, run_of
from verdicts import cause, verdict


@pytest.fixture(scope="module")
def slide():
    """A slide with 8 N of friction and 40 N/(m/s), its runs, and what the diagnosis says of it."""
    runs = [run_of(driven(seconds=8.0, coulomb=8.0, viscous=40.0))]
    return machine(), runs, diagnose(machine(), runs).verdict


@pytest.fixture
def case(slide, monkeypatch):
    for module in (checking, covering):
        monkeypatch.setattr(module, "open_case", lambda path: slide[:2])
    return slide[2]


def test_the_exported_model_follows_the_recorded_motion(case):
    """Half the square of the time times the missing force over the mass: 8 N on 12 kg are 21 mm in a quarter second."""
    found = check(case, Path("case"), None)
    (gap,) = found.gaps
    assert gap.unit == "m" and gap.before > 5e-3 and gap.after < 0.02 * gap.before and gap.closure.value > 0.99


def test_numbers_that_were_not_applied_would_show(case):
    """The check must be able to fail: with other numbers the gap does not shrink."""
    wrong = verdict(cause("coulomb_friction", force=0.1))
    (gap,) = check(wrong, Path("case"), None).gaps
    assert gap.after > 0.9 * gap.before


def test_a_model_of_the_case_has_its_forces_in_the_unit_of_the_record(case):
    """Masses and forces without a gain are in one unit, so that the motion is right; in another model they are not."""
    units = {"N": "eu", "N/(m/s)": "eu/(m/s)", "m": "m"}
    causes = [
        c.model_copy(
            update={"parameters": {n: p.model_copy(update={"unit": units[p.unit]}) for n, p in c.parameters.items()}}
        )
        for c in case.causes
    ]
    own = case.model_copy(update={"causes": causes})
    (gap,) = check(own, Path("case"), None).gaps
    assert gap.after < 0.02 * gap.before
    assert all("state the gain" in x.reason for x in export(own, "yaml").not_expressed)


def test_an_axis_that_nothing_drives_and_of_no_known_mass_is_in_no_model(slide, monkeypatch):
    pole = {
        "name": "pole",
        "motion": "rotary",
        "signals": columns("position", unit="rad"),
        "command_law": {"kind": "none"},
        "encoder_resolution": 1e-4,
    }
    chain = machine().described
    both = chain.model_copy(update={"axes": [*chain.axes, type(chain.axes[0])(**pole)]})
    runs = [
        replace(run, signals={**run.signals, "pole": {"position": np.sin(np.arange(run.ticks) * 0.01)}})
        for run in slide[1]
    ]
    monkeypatch.setattr(checking, "open_case", lambda path: (Axes(both), runs))
    assert [gap.joint for gap in check(slide[2], Path("case"), None).gaps] == ["slide"]


@pytest.mark.parametrize(("errors", "worse"), [([(1.0, 1.5), (1.0, 0.8)], True), ([(1.0, 1.1), (2.0, 0.4)], False)])
def test_a_model_is_worse_in_the_mean_over_its_joints(errors, worse):
    """(1.5^2 + 0.8^2) / 2 = 1.45; (1.1^2 + 0.2^2) / 2 = 0.63; a joint that never moved says nothing."""
    gaps = [JointGap("j", before, after, "rad", Interval(value=0.0)) for before, after in [*errors, (0.0, 0.0)]]
    assert Checked(None, gaps).worse is worse


def test_ranges_cover_motion_that_they_were_not_set_on(case):
    """A 90 % range; a third of 8 s are ten windows, so that one of them more or less is 10 %."""
    found = covered(case, Path("case"), None, {})
    assert 0.80 <= found.coverage["slide"] <= 1.0
    assert found.ranges.remainder["slide"] > 0.0


def test_what_varies_from_window_to_window_is_as_wide_as_it_must_be():
    """Errors of one newton's answer a window, models that are all right: the force that covers them is one newton."""
    rng = np.random.default_rng(0)
    time, windows = np.arange(50) * 0.005, 60
    answer = np.tile(time**2, windows)
    errors = np.repeat(rng.standard_normal(windows), 50) * answer + 1e-7 * rng.standard_normal(50 * windows)
    number = np.repeat(np.arange(windows), 50)
    seen = Windows(
        np.tile(errors, (DRAWS, 1)), errors, answer, np.tile(time, windows), number, np.zeros(50 * windows, dtype=bool)
    )
    found = scatter_of(seen)
    assert found.force == pytest.approx(1.0, rel=0.3)
    assert inside(seen, found).mean() == pytest.approx(0.9, abs=0.02)


def test_records_of_several_rates_and_lengths_are_one_gap():
    before = [np.full((3, 125), 2.0), np.full((5, 50), 2.0)]
    after = [np.full((3, 125), 1.0), np.full((5, 50), 1.0)]
    gap = checking.gap_of("joint", "rad", before, after)
    assert (gap.before, gap.after) == (2.0, 1.0) and gap.closure.value == pytest.approx(0.75)
    assert engine.steps_of(0.005) == 5 and engine.steps_of(0.00333) == 4


def test_ranges_are_90_percent_of_the_verdicts_95():
    (entry,) = worlds_of(verdict(cause("coulomb_friction", force=10.0)))
    low, high = interval(entry[0].parameters["force"])
    assert low == pytest.approx(10.0 - 1.645 / 1.96) and high == pytest.approx(10.0 + 1.645 / 1.96)
    draws = [Ranges([entry]).draw(np.random.default_rng(i))[0].parameters["force"].value for i in range(400)]
    assert np.mean([(low <= x <= high) for x in draws]) == pytest.approx(0.9, abs=0.04)


def test_rivals_are_worlds_of_their_own():
    ranges = Ranges(
        worlds_of(verdict(cause("coulomb_friction", force=1.0)), [verdict(cause("gravity_load", force=2.0))])
    )
    rng = np.random.default_rng(1)
    assert {ranges.draw(rng)[0].effect for _ in range(40)} == {"coulomb_friction", "gravity_load"}
    assert "one_of" in ranges.text()


def test_rivals_are_drawn_by_their_probability():
    """Where the verdict knows it: 0.6 against 0.2 is three draws in four."""
    own = verdict(cause("coulomb_friction", force=1.0))
    (site,) = {c.actuator for c in own.causes}
    own = own.model_copy(update={"probabilities": {f"coulomb_friction:{site}": 0.6, f"gravity_load:{site}": 0.2}})
    worlds = worlds_of(own, [verdict(cause("gravity_load", force=2.0))])
    ranges = Ranges(worlds, shares_of(own, worlds))
    assert ranges.probabilities == pytest.approx([0.75, 0.25])
    rng = np.random.default_rng(1)
    drawn = [ranges.draw(rng)[0].effect for _ in range(400)]
    assert drawn.count("coulomb_friction") == pytest.approx(300, abs=27)  # three standard deviations
    assert "probability" in ranges.text()
    assert shares_of(verdict(cause("coulomb_friction", force=1.0)), worlds) == [1.0, 1.0]


def test_without_mujoco_the_extra_is_named(case, monkeypatch):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(engine, "import_module", missing)
    with pytest.raises(MujocoMissing, match="extra"):
        check(case, Path("case"), None)


def test_a_case_of_another_kind_is_refused(case, monkeypatch):
    monkeypatch.setattr(checking, "open_case", lambda path: (object(), []))
    with pytest.raises(ExportError, match="this kind of machine"):
        check(case, Path("case"), None)


def test_an_arm_in_motion_is_run_from_its_own_model(tmp_path, monkeypatch):
    """A lift with a pendulum, friction on both joints: the URDF of the case becomes the nominal MJCF."""
    import lifts

    machine = lifts.machine(tmp_path / "lift.urdf")
    q, v, a = lifts.motion(seconds=8.0)
    runs = [lifts.run_of(q, lifts.needed(q, v, a) + lifts.friction(v, coulomb=(6.0, 0.5)))]
    monkeypatch.setattr(checking, "open_case", lambda path: (machine, runs))
    causes = (
        cause("coulomb_friction", "lift", force=6.0),
        cause("coulomb_friction", "swing", force=0.5, unit="N*m"),
    )
    found = check(verdict(*causes), Path("case"), None)
    assert [gap.joint for gap in found.gaps] == ["lift", "swing"]
    assert all(gap.after < 0.3 * gap.before for gap in found.gaps), found.gaps


def test_a_known_mass_on_an_axis_is_on_its_model_in_the_run_that_had_it(monkeypatch):
    """The description's mass is 20 % too small: without the known mass the second run would move half as far."""
    runs = [run_of(driven(seconds=8.0)), replace(run_of(driven(seconds=8.0, mass=2.0 * MASS)), name="weighed")]
    weighed = machine(mass=0.8 * MASS, carried={"weighed": MASS})
    monkeypatch.setattr(checking, "open_case", lambda path: (weighed, runs))
    (gap,) = check(verdict(cause("payload_mass", "slide", mass=0.2 * MASS, unit="kg")), Path("case"), None).gaps
    assert gap.closure.value > 0.95
    recorded = checking.recorded(weighed, runs, {}, late=False)
    assert [[load.mass for load in run.carried] for run in recorded] == [[], [MASS]]


def test_a_known_mass_on_a_link_is_on_its_model_in_the_run_that_had_it(tmp_path, monkeypatch):
    """A lift with a pendulum and friction on both joints; the second run has 0.9 kg on the pendulum."""
    import lifts

    at, (q, v, a) = (0.1, 0.1, 0.1), lifts.motion(seconds=8.0)
    friction = lifts.friction(v, coulomb=(6.0, 0.5))
    loads = {"first": 0.0, "second": 0.9}
    runs = [lifts.run_of(q, lifts.needed(q, v, a, m, at[0], at[2]) + friction, name=n) for n, m in loads.items()]
    known = {"second": {"mass": 0.9, "link": "pendulum", "centre": at}}
    arm = lifts.machine(tmp_path / "lift.urdf", carried=known)
    causes = (
        cause("coulomb_friction", "lift", force=6.0),
        cause("coulomb_friction", "swing", force=0.5, unit="N*m"),
    )
    monkeypatch.setattr(checking, "open_case", lambda path: (arm, runs))
    found = check(verdict(*causes), Path("case"), None)
    assert all(gap.after < 0.3 * gap.before for gap in found.gaps), found.gaps
    text = found.exported.text.replace('name="pendulum"', 'name="hanging"')
    model = tmp_path / "other.xml"
    model.write_text(text)
    with pytest.raises(ExportError, match="lacks what `carried` names"):
        check(verdict(*causes), Path("case"), model)


@pytest.mark.parametrize("side", ["joints", "motors"])
def test_friction_of_a_motor_behind_a_coupling_is_checked_on_the_joints(tmp_path, monkeypatch, side):
    """The second motor moves with both joints; places and forces were recorded of the joints, or of the motors."""
    import lifts

    travel = np.array([[1.0, 0.0], [1.0, 0.5]])
    machine = lifts.machine(tmp_path / "lift.urdf", coupling=travel.tolist(), effort_of=side, position_of=side)
    q, v, a = lifts.motion(seconds=8.0)
    force = lifts.needed(q, v, a) + lifts.friction(v @ travel.T, coulomb=(0.0, 3.0)) @ travel
    of = (q, force) if side == "joints" else (q @ travel.T, force @ np.linalg.inv(travel))
    monkeypatch.setattr(checking, "open_case", lambda path: (machine, [lifts.run_of(*of)]))
    answer = verdict(cause("coulomb_friction", "swing", force=3.0))
    found = check(answer, Path("case"), None, motors={"swing": {"lift": 1.0, "swing": 0.5}})
    assert all(gap.after < 0.3 * gap.before for gap in found.gaps), found.gaps


def test_a_servo_of_the_model_gives_way_to_the_recorded_force(tmp_path, monkeypatch):
    """Torques are no references: as controls of position actuators they would send the arm anywhere."""
    import lifts

    servos = "".join(f'<position joint="{j}" kp="500" kv="20"/>' for j in ("lift", "swing"))
    bare = (
        '<body name="tip"><joint name="spare" type="hinge"/><inertial pos="0 0 0" mass="0" diaginertia="0 0 0"/></body>'
    )
    text = lifts.MJCF.replace("</mujoco>", f"<actuator>{servos}</actuator></mujoco>")
    text = text.replace("</body></body></worldbody>", f"{bare}</body></body></worldbody>")
    (tmp_path / "servo.xml").write_text(text)
    machine = lifts.machine(tmp_path / "lift.urdf")
    q, v, a = lifts.motion(seconds=8.0)
    runs = [lifts.run_of(q, lifts.needed(q, v, a) + lifts.friction(v, coulomb=(6.0, 0.5)))]
    monkeypatch.setattr(checking, "open_case", lambda path: (machine, runs))
    causes = (
        cause("coulomb_friction", "lift", force=6.0),
        cause("coulomb_friction", "swing", force=0.5, unit="N*m"),
    )
    found = check(verdict(*causes), Path("case"), tmp_path / "servo.xml")
    assert all(gap.closure.value > 0.9 for gap in found.gaps), found.gaps
    assert "<position" in found.exported.text


def test_a_link_without_inertia_is_given_dust(tmp_path):
    """A frame of a URDF that moves and weighs nothing: MuJoCo refuses it as it is."""
    import lifts
    from sher3_export.check.model_of import model_of_arm

    spare = (
        '<joint name="turn" type="continuous"><parent link="pendulum"/><child link="tool"/><axis xyz="0 0 1"/></joint>'
    )
    (tmp_path / "arm.urdf").write_text(lifts.URDF.replace("</robot>", f'<link name="tool"/>{spare}</robot>'))
    root = model_of_arm(tmp_path / "arm.urdf")
    assert root.find("compiler").get("boundmass")
    assert engine.compiled(tostring(root, encoding="unicode"), ["lift", "swing"]).model.nv == 3


def test_gear_loss_is_written_as_the_friction_of_its_mean_load():
    from sher3_export.changes import changes_of

    lost = cause("gear_loss", "swing", share=0.06, force=0.15, usual=0.27, unit="N*m")
    (changes, _) = changes_of([lost])
    assert {c.constant: c.value for c in changes} == {"load_loss": 0.06, "coulomb": 0.27}
