"""URDF, SDF, Isaac and plain YAML: what is written, and what is said to be missing."""

import pinocchio
import pytest
import yaml
from sher3_effects.page import CONSTANTS
from sher3_export import TARGETS, ExportError, export
from sher3_export.targets.target import XmlTarget
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
    assert [x.constant for x in done.untold] == ["backlash", "inertia", "lag"] and not done.applied
    assert all(len(x.reason) > 20 for x in done.untold)


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
    assert [x.constant for x in done.untold] == ["stribeck"]


def test_yaml_takes_every_constant_with_its_interval():
    done = export(verdict(FRICTION, cause("backlash", width=0.01, unit="rad")), "yaml")
    joints = yaml.safe_load(done.text)["joints"]["slide"]
    assert joints["coulomb"][0] == {"value": 2.0, "low": 1.8, "high": 2.2, "unit": "N*m", "from": "coulomb_friction"}
    assert joints["backlash"][0]["value"] == 0.01 and not done.untold


def test_every_constant_is_written_or_refused_with_a_reason_by_every_target():
    for name, target in TARGETS.items():
        if issubclass(target, XmlTarget):
            model = URDF if name == "urdf" else SDF if name == "sdf" else None
            if model is None:
                continue
            known = set(target(parse_xml(model, target.root_tag)).writers) | set(target.refuses)
            assert known == set(CONSTANTS), name


def test_a_missing_model_or_target_is_refused_with_a_remedy():
    with pytest.raises(ExportError, match="--model"):
        export(verdict(FRICTION), "urdf")
    with pytest.raises(ExportError, match="no such target"):
        export(verdict(FRICTION), "gazebo")
