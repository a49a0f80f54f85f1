"""Every node as a program of its own, on mocks: `ros2 launch sher3_bringup nodes.launch.py ns:=/left`."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, TimerAction
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

NODES = ("force_sensor", "pedal", "admittance", "kinematics", "motor_driver", "supervisor")
DEVICES_FIRST = 3.0
"""Seconds that the plant has to bring up the mock devices: the drivers look for them when they start."""


def _node(name: str) -> Node:
    options = ["--rate", LaunchConfiguration("rate"), "--patient"]
    space = LaunchConfiguration("ns")
    return Node(package="sher3_bringup", executable=name, arguments=options, namespace=space, output="screen")


def generate_launch_description() -> LaunchDescription:
    """Return the plant, and the other nodes a little later."""
    return LaunchDescription(
        [
            DeclareLaunchArgument("rate", default_value="500", description="control rate [Hz]"),
            DeclareLaunchArgument("ns", default_value="/sher3", description="namespace of nodes and topics"),
            _node("plant"),
            TimerAction(period=DEVICES_FIRST, actions=[_node(name) for name in NODES]),
        ]
    )
