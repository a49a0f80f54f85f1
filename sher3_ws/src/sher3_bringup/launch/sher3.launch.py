"""The robot with its state for other ROS tools: `ros2 launch sher3_bringup sher3.launch.py record:=bags/run`."""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, ExecuteProcess
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration, PythonExpression


def generate_launch_description() -> LaunchDescription:
    """Return `sher3 up`, which starts, watches and stops every node, and `sher3 state` beside it."""
    rate, domain, record, view = (LaunchConfiguration(name) for name in ("rate", "domain", "record", "view"))
    recording = PythonExpression(["'--record ", record, "' if '", record, "' else ''"])
    seen = PythonExpression(["'--view' if '", view, "' == 'true' else ''"])
    options = LaunchConfiguration("options")
    robot = ["sher3 up --rate ", rate, " --domain ", domain, " ", recording, " ", seen, " ", options]
    state = ["sher3 state --parameters --domain ", domain]
    wanted = IfCondition(LaunchConfiguration("state"))
    return LaunchDescription(
        [
            DeclareLaunchArgument("rate", default_value="500", description="control rate [Hz]"),
            DeclareLaunchArgument("domain", default_value="0", description="ROS domain id"),
            DeclareLaunchArgument("record", default_value="", description="folder of the recording, none if empty"),
            DeclareLaunchArgument("view", default_value="false", description="true: also the live page"),
            DeclareLaunchArgument("state", default_value="true", description="true: also `sher3 state`"),
            DeclareLaunchArgument("options", default_value="", description="further options of `sher3 up`"),
            ExecuteProcess(cmd=[robot], shell=True, output="screen", sigterm_timeout="10"),
            ExecuteProcess(cmd=[state], shell=True, output="screen", condition=wanted),
        ]
    )
