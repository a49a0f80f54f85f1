"""A running robot for ROS tools: parameters through the standard services, refusals in /rosout."""

from __future__ import annotations

import subprocess

import pytest
from processes import child_environment, sher3_command

pytestmark = [pytest.mark.graph, pytest.mark.slow, pytest.mark.flaky(reruns=2)]
CLIENT = """
import sys, time, rclpy
from rcl_interfaces.msg import Log, Parameter, ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from sher3_runtime import environment

environment.apply(int(sys.argv[1]))
rclpy.init()
node, lines = rclpy.create_node("tool"), []
node.create_subscription(
    Log, "/rosout", lambda m: lines.append(f"{m.level} {m.name} {m.msg}"),
    QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL),
)

def call(kind, name, request):
    client = node.create_client(kind, f"/sher3/parameters/{name}")
    assert client.wait_for_service(30.0)
    future = client.call_async(request)
    rclpy.spin_until_future_complete(node, future, timeout_sec=20.0)
    return future.result()

def put(name, **value):
    wish = Parameter(name=name, value=ParameterValue(**value))
    return call(SetParameters, "set_parameters", SetParameters.Request(parameters=[wish])).results[0]

end, names = time.monotonic() + 40.0, []
while not {"speed_scale", "regime"} <= set(names) and time.monotonic() < end:
    names = call(ListParameters, "list_parameters", ListParameters.Request()).result.names
print("listed", "speed_scale" in names, "regime" in names, "law.admittance.linear_gain" in names)
print("set", put("speed_scale", type=3, double_value=0.5).successful)
wanted, value, end = GetParameters.Request(names=["speed_scale"]), None, time.monotonic() + 10.0
while value != 0.5 and time.monotonic() < end:
    value = call(GetParameters, "get_parameters", wanted).values[0].double_value
print("got", value)
refused = put("speed_scale", type=3, double_value=7.0)
print("refused", refused.successful, refused.reason)
fixed = put("motion.speed", type=3, double_value=0.1)
print("fixed", fixed.successful, fixed.reason)
end = time.monotonic() + 10.0
while not any("out of range" in line for line in lines) and time.monotonic() < end:
    rclpy.spin_once(node, timeout_sec=0.1)
print("log", [line for line in lines if "out of range" in line])
"""


@pytest.fixture
def running(domain):
    """A robot with its state published."""
    commands = (["up", "--patient", "--duration", "120"], ["state", "--parameters", "--for", "120"])
    processes = []
    for command in commands:
        arguments = sher3_command(*command, "--domain", str(domain))
        processes.append(subprocess.Popen(arguments, env=child_environment(), stdout=subprocess.PIPE, text=True))
        if command[0] == "up":
            assert processes[-1].stdout.readline().startswith("ready")
    try:
        yield domain
    finally:
        for process in reversed(processes):
            process.terminate()
            process.wait(30.0)


def test_parameters_are_listed_set_and_refused_and_the_log_tells_it(running):
    python = sher3_command()[0]
    result = subprocess.run(
        [python, "-c", CLIENT, str(running)], env=child_environment(), capture_output=True, text=True, timeout=120
    )
    told = dict(line.split(" ", 1) for line in result.stdout.splitlines())
    assert told["listed"] == "True True True", result.stdout + result.stderr
    assert told["set"] == "True" and float(told["got"]) == 0.5
    assert told["refused"].startswith("False speed_scale out of range"), told
    assert told["fixed"] == "False motion.speed is fixed at the start of the robot"
    assert "30 sher3.admittance speed_scale out of range; value 7" in told["log"]
