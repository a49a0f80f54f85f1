"""What leaves the machine, who may speak, and what the documentation says of both."""

import importlib.util
import json
import subprocess
import sys

import pytest
from processes import child_environment
from sher3_bringup.settings.run_settings import RunSettings
from sher3_bringup.stepped_robot import SteppedRobot
from sher3_control.nodes.supervisor_node import OWN
from sher3_description.topics import MANY_SENDERS
from sher3_runtime import Graph
from sher3_runtime.environment import LOOPBACK_PROFILE, graph_environment
from sher3_runtime.ports import ports
from sources import ROOT, SOURCES

DOCS = ROOT / "docs" / "reference" / "security.md"


def tool(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "tools" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_by_default_the_middleware_is_bound_to_the_loopback_interface():
    """That its sockets really are is seen in `test_every_socket_is_bound_to_the_loopback_interface`."""
    assert RunSettings().other_hosts is False
    variables = graph_environment()
    assert variables["FASTDDS_DEFAULT_PROFILES_FILE"] == str(LOOPBACK_PROFILE)
    assert variables["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "SYSTEM_DEFAULT"
    profile = LOOPBACK_PROFILE.read_text()
    assert "<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList>" in profile
    assert "<useBuiltinTransports>false</useBuiltinTransports>" in profile


def test_another_machine_is_an_option_that_must_be_asked_for():
    variables = graph_environment(other_hosts=True)
    assert variables["FASTDDS_DEFAULT_PROFILES_FILE"] == "" and variables["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "SUBNET"
    assert "--other-hosts" in DOCS.read_text()


def test_the_middleware_of_the_wheels_has_no_dds_security_and_the_documentation_says_so():
    """The day this fails, enclaves can be used: change the documentation."""
    command = [sys.executable, str(ROOT / "tools" / "dds_security.py"), "--json"]
    run = subprocess.run(command, env=child_environment(), capture_output=True, text=True, timeout=60, check=False)
    found = json.loads(run.stdout)
    assert run.returncode == 1 and found["dds_security"] is False
    lacking = tool("dds_security").LACKING
    assert lacking in found["middleware"] and lacking in DOCS.read_text()


@pytest.mark.graph
def test_whatever_the_robot_obeys_has_one_owner():
    """A stranger on a topic without one would be obeyed beside the owner, and nobody would say so.

    The user's commands have as many senders as the user has windows; diagnostics have as many as there are nodes, and
    can only stop. What the mocks are told is between them and a scripted surgeon.
    """
    with Graph() as graph:
        robot = SteppedRobot(graph)
        mocks = set(ports(robot.plant).subscriptions)
        obeyed = {name for node in graph.nodes if node is not robot.plant for name in ports(node).subscriptions}
    assert {name.split("/")[0] for name in mocks} == {"mock"}
    assert {name for name in obeyed - set(OWN) if not name.startswith("command/")} <= MANY_SENDERS
    assert len(obeyed) > 20


@pytest.mark.graph
def test_the_shipped_policy_is_that_of_the_nodes():
    shipped = SOURCES / "sher3_bringup" / "sher3_bringup" / "security" / "policy.xml"
    assert shipped.read_text() == tool("sros2_policy").policy(), "run tools/sros2_policy.py"
