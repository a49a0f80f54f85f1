"""The number of the verdict stands in every target that has a place for the noise of a reading."""

import ast

import mujoco
import pytest
import sher3_export
import yaml
from sher3_diagnosis.verdict import Noise
from sher3_effects.page import NOISE
from sher3_export import TARGETS, export
from sher3_export.ranges import Ranges
from sher3_export.xml_file import parse_xml
from verdicts import cause, verdict

MJCF = """<mujoco><worldbody><body><joint name="slide" type="slide" armature="1"/><geom size="0.1"/></body></worldbody>
<actuator><motor name="drive" joint="slide"/></actuator><sensor><jointpos name="place" joint="slide"/>
<actuatorfrc name="force" actuator="drive"/><jointvel name="speed" joint="slide"/></sensor></mujoco>"""
POSITION, EFFORT = 2.5e-6, 0.04
SAID = verdict(cause("coulomb_friction", force=2.0)).model_copy(
    update={
        "noise": [
            Noise(actuator="slide", reading="position", deviation=POSITION, resolution=1e-6, unit="m"),
            Noise(actuator="slide", reading="effort", deviation=EFFORT, unit="N"),
            Noise(actuator="other", reading="effort", deviation=7.0, unit="A"),
        ]
    }
)


def test_ros2_control_has_it_at_the_interfaces():
    root = parse_xml(export(SAID, "ros2_control").text, "ros2_control")
    params = {
        (x.get("name"), p.get("name")): float(p.text) for x in root.iter("state_interface") for p in x.findall("param")
    }
    assert params == {("position", "noise"): POSITION, ("position", "resolution"): 1e-6, ("effort", "noise"): EFFORT}
    assert [j.get("name") for j in root.iter("joint")] == ["slide"]  # nobody made newtons of the amperes


def test_mujoco_loads_it_as_a_number_and_at_its_sensors_and_writing_it_twice_changes_nothing():
    once = parse_xml(export(SAID, "mjcf", parse_xml(MJCF, "mujoco")).text, "mujoco")
    for text in (export(SAID, "mjcf", once).text,):
        model = mujoco.MjModel.from_xml_string(text)
        assert model.numeric("slide/noise_position").data == pytest.approx([POSITION])
        assert model.numeric("slide/resolution_position").data == pytest.approx([1e-6])
        noise = {model.sensor(i).name: float(model.sensor_noise[i]) for i in range(model.nsensor)}
        assert noise == pytest.approx({"place": POSITION, "force": EFFORT, "speed": 0.0})
        assert model.nsensor == 3 and text.count('name="slide/noise_position"') == 1


@pytest.mark.parametrize("target", ["isaaclab", "mjlab"])
def test_observation_noise_is_a_table_of_the_file(target):
    set_ = [node for node in ast.parse(export(SAID, target).text).body if isinstance(node, ast.Assign)]
    assert next(ast.literal_eval(node.value) for node in set_ if node.targets[0].id == "NOISE") == {
        "slide": {"noise_position": POSITION, "resolution_position": 1e-6, "noise_effort": EFFORT}
    }


def test_yaml_and_ranges_have_it():
    assert yaml.safe_load(export(SAID, "isaac").text)["noise"]["slide"]["noise_effort"] == EFFORT
    assert yaml.safe_load(export(SAID, "yaml").text)["joints"]["slide"]["noise_effort"][0]["value"] == EFFORT
    ranges = yaml.safe_load(Ranges([SAID.causes], noise=SAID.noise).text())["noise"]
    assert ranges[0] == {
        "actuator": "slide",
        "reading": "position",
        "deviation": POSITION,
        "resolution": 1e-6,
        "unit": "m",
    }


def test_a_target_without_a_place_for_it_says_so_in_its_table_and_not_of_every_joint():
    for name in ("urdf", "sdf"):
        assert set(NOISE) <= set(TARGETS[name].refuses)
    urdf = '<robot name="r"><link name="a"/><link name="b"/><joint name="slide" type="prismatic"/></robot>'
    assert not export(SAID, "urdf", parse_xml(urdf, "robot")).not_expressed


def test_every_name_of_the_package_can_be_imported():
    assert all(getattr(sher3_export, name) for name in dir(sher3_export))
