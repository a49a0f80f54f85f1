"""URDF, SDF, Isaac and plain YAML: what is written, and what is said to be missing."""

import json
import sys
from functools import partial
from pathlib import Path
from types import ModuleType

import mujoco
import pinocchio
import pytest
import yaml
from sher3_effects.page import CONSTANTS, NOISE
from sher3_export import TARGETS, ExportError, export
from sher3_export.xml_file import parse_xml
from verdicts import cause, verdict

URDF = """<robot name="r"><link name="a"/><link name="b"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 1" rpy="0.3 0 0"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="9" velocity="1"/><dynamics friction="0.5"/></joint></robot>"""
SDF = """<sdf version="1.9"><model name="m"><joint name="slide" type="revolute"><axis><xyz>0 0 1</xyz>
<dynamics><friction>0.5</friction></dynamics></axis></joint></model></sdf>"""
FRICTION = cause("coulomb_friction", force=2.0, unit="N*m")
DAMPING = cause("viscous_friction", extra=0.3, unit="N*m/(rad/s)")


def test_urdf_takes_friction_damping_limit_and_zero():
    causes = (FRICTION, DAMPING, cause("force_saturation", limit=4.0), cause("encoder_offset", offset=0.1, unit="rad"))
    done = export(verdict(*causes), "urdf", parse_xml(URDF, "robot"))
    joint = parse_xml(done.text, "robot").find("joint")
    assert float(joint.find("dynamics").get("friction")) == 2.5
    assert float(joint.find("dynamics").get("damping")) == 0.3
    assert float(joint.find("limit").get("effort")) == 4.0
    # reading 0.1 in the exported model is where the nominal one reads 0
    nominal, exported = (pinocchio.buildModelFromXML(text) for text in (URDF, done.text))
    place = []
    for model, q in ((nominal, 0.0), (exported, 0.1)):
        data = model.createData()
        pinocchio.forwardKinematics(model, data, pinocchio.utils.np.array([q]))
        place.append(data.oMi[1].homogeneous)
    assert place[0] == pytest.approx(place[1], abs=1e-9)


def test_urdf_names_what_it_has_no_field_for():
    causes = (cause("backlash", width=0.01), cause("payload_mass", mass=1.0), cause("drive_lag", time_constant=0.1))
    done = export(verdict(*causes), "urdf", parse_xml(URDF, "robot"))
    assert [x.constant for x in done.not_expressed] == ["backlash", "inertia", "lag"] and not done.applied
    assert all(len(x.reason) > 20 for x in done.not_expressed)


def test_sdf_takes_friction_and_damping():
    done = export(verdict(FRICTION, DAMPING), "sdf", parse_xml(SDF, "sdf"))
    dynamics = parse_xml(done.text, "sdf").find("model/joint/axis/dynamics")
    assert float(dynamics.findtext("friction")) == 2.5 and float(dynamics.findtext("damping")) == 0.3


def test_isaac_takes_friction_at_rest_and_in_motion_and_counts_delays_in_steps():
    stribeck = cause("stribeck_friction", force=2.0, static=3.0, stribeck_velocity=0.1)
    done = export(verdict(stribeck, DAMPING, cause("command_delay", delay=0.012, unit="s")), "isaac")
    group = yaml.safe_load(done.text)["actuators"]["slide"]
    assert group["friction"] == 3.0 and group["dynamic_friction"] == 2.0 and group["viscous_friction"] == 0.3
    assert group["class"].endswith("DelayedPDActuatorCfg") and (group["min_delay"], group["max_delay"]) == (2, 3)
    assert [x.constant for x in done.not_expressed] == ["stribeck"]


def test_yaml_takes_every_constant_with_its_interval():
    done = export(verdict(FRICTION, cause("backlash", width=0.01, unit="rad")), "yaml")
    joints = yaml.safe_load(done.text)["joints"]["slide"]
    assert joints["coulomb"][0] == {"value": 2.0, "low": 1.8, "high": 2.2, "unit": "N*m", "from": "coulomb_friction"}
    assert joints["backlash"][0]["value"] == 0.01 and not done.not_expressed


MJCF = """<mujoco><default><joint damping="0.1"/></default><worldbody><body><joint name="slide" frictionloss="0.5"/>
<geom size="0.1"/></body></worldbody></mujoco>"""


XML = {"urdf": URDF, "sdf": SDF, "mjcf": MJCF}


@pytest.mark.parametrize("name", TARGETS)
def test_every_constant_is_written_or_refused_with_a_reason_by_every_target(name):
    target = TARGETS[name]
    assert set(target.fields) | set(target.refuses) == set(CONSTANTS)
    assert all(len(reason) > 20 for reason in target.refuses.values())


FIELDS = json.loads((Path(__file__).parent / "fields.json").read_text())
"""Fields of the classes of Isaac Lab and mjlab, read off their wheels by `tools/library_fields.py`."""


class Group:
    """Stands for the class of a library: it takes the fields that the library has, those that must be given among them.

    The libraries themselves import their simulators and a GPU's tool kit.
    """

    def __init__(self, known, **given):
        assert set(given) <= set(known), set(given) - set(known)
        assert not {name for name, needed in known.items() if needed} - set(given)
        self.__dict__.update(given)


LIBRARIES = {
    found["module"]: {name: partial(Group, known) for name, known in found["classes"].items()}
    for found in FIELDS.values()
}


@pytest.mark.parametrize("name", ["isaaclab", "mjlab"])
def test_the_version_that_is_named_is_the_one_whose_fields_are_known(name):
    library, version = TARGETS[name].version.rsplit(" ", 1)
    assert FIELDS[name]["version"].startswith(version) and library.replace(" ", "").lower() == name
    assert FIELDS[name]["licence"] in ("BSD-3-Clause", "Apache-2.0")
    of_actuators = [text for constant, text in TARGETS[name].fields.items() if constant not in NOISE]
    written = {field for text in of_actuators for field in text.split(", ")}
    assert written <= set(FIELDS[name]["classes"][TARGETS[name].servo or TARGETS[name].delayed])


def loaded(text, monkeypatch):
    """Run a configuration as its library would, against the documented fields."""
    for module, classes in LIBRARIES.items():
        stand_in = ModuleType(module)
        stand_in.__dict__.update(classes)
        monkeypatch.setitem(sys.modules, module.split(".")[0], ModuleType(module.split(".")[0]))
        monkeypatch.setitem(sys.modules, module, stand_in)
    space = {}
    exec(text, space)
    return space["ACTUATORS"], space["RANGES"]


CAUSES = (
    FRICTION,
    DAMPING,
    cause("rotor_inertia", inertia=0.02, unit="kg*m^2"),
    cause("force_saturation", limit=4.0, unit="N*m"),
    cause("command_delay", delay=0.012, unit="s"),
)


def test_isaaclab_s_file_is_python_with_fields_that_isaac_lab_has(monkeypatch):
    done = export(verdict(*CAUSES), "isaaclab", parse_xml(MJCF, "mujoco"))
    actuators, ranges = loaded(done.text, monkeypatch)
    slide = actuators["slide"]
    assert (slide.dynamic_friction, slide.friction) == (2.5, 2.5) and slide.viscous_friction == pytest.approx(0.4)
    assert (slide.armature, slide.actuator_effort_limit, slide.stiffness) == (0.02, 4.0, None)
    assert (slide.min_delay, slide.max_delay) == (6, 6) and not done.not_expressed  # MuJoCo's step where none is stated
    assert ranges["slide"]["dynamic_friction"] == pytest.approx((2.3, 2.7))


def test_a_delay_is_counted_in_the_steps_that_the_model_states(monkeypatch):
    stated = MJCF.replace("<mujoco>", '<mujoco><option timestep="0.005"/>')
    text = export(verdict(*CAUSES), "mjlab", parse_xml(stated, "mujoco")).text
    slide = loaded(text, monkeypatch)[0]["slide"]
    assert (slide.delay_min_lag, slide.delay_max_lag) == (2, 3) and "steps of 0.005 s" in text


SERVO = """<mujoco><worldbody><body><joint name="slide"/><geom size=".1"/></body></worldbody>
<actuator>{}</actuator></mujoco>"""


def test_gains_of_a_servo_are_written_where_the_model_states_them(monkeypatch):
    weak = verdict(cause("controller_gain", relative=-0.1, unit="1"))
    servo = parse_xml(SERVO.format('<position joint="slide" kp="50" kv="2" gear="2"/>'), "mujoco")
    slide = loaded(export(weak, "isaaclab", servo).text, monkeypatch)[0]["slide"]
    assert (slide.stiffness, slide.damping) == (pytest.approx(180.0), pytest.approx(7.2))
    for model in (None, parse_xml(SERVO.format('<motor joint="slide"/>'), "mujoco")):
        (left,) = export(weak, "isaaclab", model).not_expressed
        assert "give --model with position actuators" in left.reason


def test_a_servo_of_other_gains_is_an_actuator_of_mjlab_s_own(monkeypatch):
    weak = verdict(cause("controller_gain", relative=-0.1, unit="1"), FRICTION)
    text = export(weak, "mjlab", parse_xml(SERVO.format('<position joint="slide" kp="50" kv="2"/>'), "mujoco")).text
    actuators, ranges = loaded(text, monkeypatch)
    slide = actuators["slide"]
    assert (slide.stiffness, slide.damping) == (pytest.approx(45.0), pytest.approx(1.8))
    assert "BuiltinPositionActuatorCfg(" in text and "out of the MJCF" in text
    assert ranges["slide"]["stiffness"] == pytest.approx((45.5, 44.5))
    assert "XmlActuatorCfg(" in export(verdict(FRICTION), "mjlab").text


def test_ranges_stand_in_every_target():
    """Which a program reads, or where the format has no place for them a person, in the comment on top."""
    text = {name: export(verdict(FRICTION), name).text for name in TARGETS if name not in XML}
    text |= {name: export(verdict(FRICTION), name, parse_xml(XML[name], TARGETS[name].root_tag)).text for name in XML}
    assert all("friction in motion 2 N*m (1.8 to 2.2)" in x for x in text.values())
    assert yaml.safe_load(text["isaac"])["ranges"] == {"slide": {"dynamic_friction": [1.8, 2.2]}}
    joint = parse_xml(text["ros2_control"], "ros2_control").find("joint")
    found = {x.get("name"): x.text for x in joint.findall("param")}
    assert found == {"coulomb": "2", "coulomb_low": "1.8", "coulomb_high": "2.2"}


def test_mujoco_loads_the_ranges_and_an_export_later_adds_to_them():
    once = export(verdict(FRICTION), "mjcf", parse_xml(MJCF, "mujoco")).text
    twice = export(verdict(FRICTION), "mjcf", parse_xml(once, "mujoco")).text
    for text, between in ((once, (1.8, 2.2)), (twice, (3.6, 4.4))):
        assert mujoco.MjModel.from_xml_string(text).numeric("slide/coulomb").data == pytest.approx(between)


def given(text, monkeypatch, xml):
    """Return friction, damping and rotor inertia of the first joint of a model with what mjlab's file says of it."""
    loaded(text, monkeypatch)
    space = {}
    exec(text, space)
    model = space["with_joints"](mujoco.MjSpec.from_string(xml)).compile()
    return [float(x[0]) for x in (model.dof_frictionloss, model.dof_damping, model.dof_armature)]


def test_what_is_of_the_joints_is_written_into_the_specification_that_mjlab_loads(monkeypatch):
    """Its actuators take `frictionloss`, and leave the joint as the MJCF has it."""
    text = export(verdict(*CAUSES), "mjlab", parse_xml(MJCF, "mujoco")).text
    assert given(text, monkeypatch, MJCF) == pytest.approx([2.5, 0.4, 0.02])
    assert "frictionloss" not in text.split("RANGES = ")[0].split("ACTUATORS = ")[1]


def test_mjlab_s_file_is_python_with_fields_that_mjlab_has(monkeypatch):
    done = export(verdict(*CAUSES), "mjlab", parse_xml(URDF, "robot"))
    actuators, ranges = loaded(done.text, monkeypatch)
    slide = actuators["slide"]
    assert slide.target_names_expr == ("slide",)
    assert (slide.delay_min_lag, slide.delay_max_lag) == (2, 3) and set(ranges["slide"]) == {
        "frictionloss",
        "viscous_damping",
        "armature",
    }
    assert [(x.constant, "--to mjcf" in x.reason) for x in done.not_expressed] == [("limit", True)]


def test_without_a_model_a_configuration_says_that_its_values_add(monkeypatch):
    text = export(verdict(FRICTION), "isaaclab").text
    assert "add what your asset has, or give --model" in text
    assert loaded(text, monkeypatch)[0]["slide"].dynamic_friction == 2.0


@pytest.mark.parametrize("name", ["isaaclab", "mjlab"])
def test_a_name_of_a_joint_stays_a_name(name, monkeypatch):
    """Quotes, code and ends of lines in a name neither end its text nor the comment on top."""
    evil = 'a"]\nraise SystemExit #'
    actuators, _ = loaded(export(verdict(cause("coulomb_friction", evil, force=2.0)), name).text, monkeypatch)
    assert list(actuators) == [evil]


def test_ros2_control_s_element_parses_and_stays_in_its_schema():
    done = export(verdict(*CAUSES, cause("payload_mass", mass=1.0)), "ros2_control")
    root = parse_xml(done.text, "ros2_control")
    assert root.get("type") == "system" and root.findtext("hardware/plugin") == "mock_components/GenericSystem"
    joint = root.find("joint")
    assert {x.tag for x in joint} == {"command_interface", "param", "state_interface"}
    found = {x.get("name"): float(x.text) for x in joint.findall("param")}
    assert found["coulomb"] == 2.0 and found["delay"] == 0.012 and "limit" not in found
    limits = {x.get("name"): float(x.text) for x in joint.findall("command_interface/param")}
    assert limits == {"min": -4.0, "max": 4.0}


def test_a_missing_model_or_target_is_refused_with_a_remedy():
    with pytest.raises(ExportError, match="--model"):
        export(verdict(FRICTION), "urdf")
    with pytest.raises(ExportError, match="no such target"):
        export(verdict(FRICTION), "gazebo")
