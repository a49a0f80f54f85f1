"""Processor time of `sher3 gap watch`, without its diagnoses, at 500 Hz and seven joints."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import rclpy
from sensor_msgs.msg import JointState

sys.path.append(str(Path(__file__).parents[1] / "tests"))

from processes import child_environment, sher3_command

RATE, JOINTS, SECONDS, SETTLED = 500.0, 7, 20.0, 5.0
LINK = (
    '<link name="l{1}"><inertial><mass value="1"/><inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/>'
    '</inertial></link><joint name="j{1}" type="revolute"><parent link="l{0}"/><child link="l{1}"/><axis xyz="0 1 0"/>'
    '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>'
)


def processor(pid: int) -> float:
    """Return the processor time of a process so far, s."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Print the share of a core."""
    os.environ.update(child_environment())
    rclpy.init()
    node = rclpy.create_node("player")
    publisher = node.create_publisher(JointState, "/joint_states", 10)
    names = [f"j{i + 1}" for i in range(JOINTS)]
    links = "".join(LINK.format(i, i + 1) for i in range(JOINTS))
    with TemporaryDirectory() as folder:
        model = Path(folder, "arm.urdf")
        model.write_text(f'<robot name="arm"><link name="l0"/>{links}</robot>')
        watched = subprocess.Popen(sher3_command("gap", "watch", "--model", str(model), "--every", "1000"))
        begun, used, since = time.monotonic(), 0.0, 0.0
        sent, whole = 0, round((SETTLED + SECONDS) * RATE)
        for k in range(whole):
            now = node.get_clock().now().to_msg()
            message = JointState(name=names, position=np.sin(0.01 * k + np.arange(JOINTS)).tolist())
            message.header.stamp, message.effort = now, [1.0] * JOINTS
            publisher.publish(message)
            sent += 1
            if k == round(SETTLED * RATE):
                used, since = processor(watched.pid), time.monotonic()
            time.sleep(max(0.0, begun + k / RATE - time.monotonic()))
        share = (processor(watched.pid) - used) / (time.monotonic() - since)
        watched.send_signal(2)
        watched.wait(20)
    print(f"{share:.1%} of a core at {sent / (time.monotonic() - begun):.0f} Hz, {JOINTS} joints")
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
