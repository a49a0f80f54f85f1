"""`sher3 gap watch`: the window, what is made of it, and the node beside a plain publisher."""

import subprocess
import time
from types import SimpleNamespace

import numpy as np
import pytest
from invoking import invoke
from sher3_chain.manipulator.causes.links import OTHER_ROBOT
from sher3_gap_cli.app import app
from sher3_gap_cli.watch.judged import OK, STALE, WARN, actuator_commands, judged
from sher3_gap_cli.watch.trajectory import Point, set_points
from sher3_gap_cli.watch.window import Window
from sher3_public import one_call

ARM = (
    '<robot name="a"><link name="base"/><link name="arm"><inertial><origin xyz="0.2 0 0"/><mass value="2"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>'
    '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint></robot>'
)
INERTIA = 0.01 + 2 * 0.2**2


def moved(t, friction):
    """Return position and effort of the arm that turns about the vertical, with dry friction, N m."""
    place = 0.6 * np.sin(1.7 * t) + 0.3 * np.sin(4.1 * t)
    speed = 0.6 * 1.7 * np.cos(1.7 * t) + 0.3 * 4.1 * np.cos(4.1 * t)
    force = INERTIA * -(0.6 * 1.7**2 * np.sin(1.7 * t) + 0.3 * 4.1**2 * np.sin(4.1 * t))
    return place, force + friction * np.tanh(speed / 1e-3)


def test_a_window_keeps_its_seconds_in_the_model_s_order_at_its_rate():
    window = Window(["a", "b"], seconds=2.0, rate=50.0)
    assert window.taken() is None
    for k in range(1000):
        window.state(0.005 * k, ["c", "b", "a"], [9.0, 0.01 * k, -0.01 * k], [0.0, 2.0, 1.0])
    taken = window.taken()
    assert taken.command is None and len(taken.time) in (100, 101) and taken.time[0] == 0.0
    assert np.diff(taken.time) == pytest.approx(0.02) and taken.position[-1] == pytest.approx([-9.96, 9.96])
    assert (taken.effort == [1.0, 2.0]).all() and window.heard == 1000
    assert window.due(5.0) and window.due(0.0) and not window.due(4.99)


def test_commands_hold_until_the_next_and_the_window_begins_with_the_first():
    window = Window(["a", "b"], seconds=2.0, rate=100.0)
    window.command(0.5, ["b", "a"], [2.0, 1.0])
    window.command(1.0, [], [3.0, 4.0])
    for k in range(201):
        window.state(0.01 * k, ["a", "b"], [0.0, 0.0], [])
    taken = window.taken()
    assert taken.effort is None and len(taken.time) == 151
    assert (taken.command[:50] == [1.0, 2.0]).all() and (taken.command[50:] == [3.0, 4.0]).all()


def test_points_of_a_trajectory_are_joined_by_lines_or_cubics():
    after, lines = set_points([Point(1.0, [2.0])], before=[0.0], period=0.25)
    assert after.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0] and lines[:, 0] == pytest.approx([0.0, 0.5, 1.0, 1.5, 2.0])
    _, cubic = set_points([Point(1.0, [2.0], [0.0])], before=[0.0], period=0.25)
    assert cubic[:, 0] == pytest.approx([2.0 * (3.0 * s**2 - 2.0 * s**3) for s in after])


def test_a_trajectory_takes_the_place_of_what_was_planned_and_begins_where_the_last_one_is():
    window = Window(["a", "b"], seconds=2.0, rate=10.0)
    window.trajectory(0.0, ["a"], [Point(0.0, [0.0]), Point(10.0, [10.0])])
    window.trajectory(1.0, ["b"], [Point(1.0, [5.0])])
    for k in range(21):
        window.state(0.1 * k, ["a", "b"], [0.0, 0.0], [])
    command = window.taken().command
    assert command[:10, 0] == pytest.approx(np.arange(10) * 0.1) and (command[:10, 1] == 0.0).all()
    assert command[10:, 0] == pytest.approx(0.9) and command[-1, 1] == pytest.approx(5.0)
    window.trajectory(3.0, ["c"], [Point(1.0, [5.0])])
    assert window.strange == 1


def test_strange_messages_are_counted_and_a_clock_that_goes_back_begins_anew():
    window = Window(["a"], seconds=2.0, rate=100.0)
    window.state(0.0, ["b"], [1.0], [])
    window.state(0.0, ["a", "b"], [1.0], [])
    window.command(0.0, ["b"], [1.0])
    assert window.strange == 3 and not window.states
    window.state(5.0, ["a"], [1.0], [])
    window.state(1.0, ["a"], [1.0], [])
    assert [s.stamp for s in window.states] == [1.0]


@pytest.mark.parametrize(("friction", "level"), [(0.0, OK), (0.7, WARN)])
def test_a_window_is_judged(friction, level):
    t = np.arange(0.0, 12.0, 0.01)
    place, effort = moved(t, friction)
    rng = np.random.default_rng(1)
    arrays = (t, None, place[:, None], (effort + 1e-3 * rng.normal(size=len(t)))[:, None])
    found = judged(ARM, ("turn",), arrays)
    assert found[0].name == "gap" and found[0].level == level
    causes = [s.message for s in found[1:]]
    assert bool(causes) == bool(friction) and all("Coulomb friction on turn" in c for c in causes)


def test_the_model_of_another_robot_is_a_status_of_its_own(monkeypatch):
    note = f"{OTHER_ROBOT}: mass, centre or inertia of arm differ"
    other = SimpleNamespace(status="attributed", headline="so", causes=[], places=[], notes=["short", note])
    monkeypatch.setattr(one_call, "diagnose", lambda *_, **__: other)
    found = judged(ARM, ("turn",), (np.zeros(2), None, np.zeros((2, 1)), None))
    assert [(s.name, s.level, s.message) for s in found] == [("gap", WARN, "so"), ("gap/model", WARN, note)]


def test_what_cannot_be_judged_says_why():
    t = np.arange(0.0, 12.0, 0.01)
    (found,) = judged(ARM, ("turn",), (t, None, np.zeros((len(t), 1)), None))
    assert found.level == STALE and found.message


def test_a_command_of_joints_is_put_in_the_order_of_the_actuators():
    from sher3_public.models import source_of

    xml = (
        '<mujoco><worldbody><body><joint name="a" axis="0 1 0"/><geom size=".1"/><body><joint name="b" axis="0 1 0"/>'
        '<geom size=".1"/></body></body></worldbody><actuator><motor joint="b"/><motor joint="a"/></actuator></mujoco>'
    )
    assert actuator_commands(source_of(xml).bodies, ("a", "b"), np.array([[1.0, 2.0]])).tolist() == [[2.0, 1.0]]
    assert actuator_commands(source_of(ARM).bodies, ("turn",), np.array([[1.0]])) is None


def test_what_is_waited_for_is_said():
    window = Window(["turn", "finger"], seconds=10.0, rate=50.0)
    assert window.waits_for("/joint_states") == "waiting for joint states on /joint_states"
    window.state(0.0, ["turn"], [0.0], [])
    assert "joint states on /arm lack finger: name the joints to watch, --joint" in window.waits_for("/arm")
    window.state(0.1, ["finger", "turn"], [0.0, 0.0], [])
    assert window.waits_for("/arm") == "gathering the first 5 s"


@pytest.mark.graph
def test_a_joint_that_the_model_lacks_is_refused(tmp_path):
    (tmp_path / "arm.urdf").write_text(ARM)
    result = invoke(app, ["watch", "--model", str(tmp_path / "arm.urdf"), "--joint", "trun"])
    assert result.exit_code == 2 and "the model has no such joint" in result.output


@pytest.mark.graph
@pytest.mark.flaky(reruns=2)
@pytest.mark.parametrize(
    ("quality", "words"),
    [
        ({"reliability": "RELIABLE", "durability": "TRANSIENT_LOCAL"}, []),
        ({"reliability": "BEST_EFFORT", "durability": "VOLATILE"}, ["--best-effort"]),
    ],
)
def test_a_plain_publisher_s_friction_is_named_on_diagnostics(tmp_path, monkeypatch, quality, words):
    """A recorded arm is played at 100 Hz by an ordinary node; the causes come back as diagnostics."""
    import rclpy
    from diagnostic_msgs.msg import DiagnosticArray
    from processes import child_environment, sher3_command
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import JointState

    (tmp_path / "arm.urdf").write_text(ARM)
    for name, value in child_environment().items():
        monkeypatch.setenv(name, value)
    words = ["gap", "watch", "--model", tmp_path / "arm.urdf", "--window", "6", "--every", "2", *words]
    watched = subprocess.Popen(sher3_command(*words), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    context, heard = rclpy.Context(), {}
    rclpy.init(context=context)  # of its own: other tests of this process start and stop the common one
    node, executor = rclpy.create_node("player", context=context), SingleThreadedExecutor(context=context)
    executor.add_node(node)
    try:
        policies = (ReliabilityPolicy[quality["reliability"]], DurabilityPolicy[quality["durability"]])
        profile = QoSProfile(depth=10, reliability=policies[0], durability=policies[1])
        publisher = node.create_publisher(JointState, "/joint_states", profile)
        node.create_subscription(
            DiagnosticArray, "/diagnostics", lambda m: heard.update({s.name: s.message for s in m.status}), 10
        )
        begun = time.monotonic()
        for k in range(18_000):
            place, effort = moved(0.01 * k, 0.7)
            message = JointState(name=["turn"], position=[float(place)], effort=[float(effort)])
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(k * 10_000_000, 1_000_000_000)
            publisher.publish(message)
            executor.spin_once(timeout_sec=0.0)
            time.sleep(max(0.0, begun + 0.01 * k - time.monotonic()))
            if "gap/turn" in heard or watched.poll() is not None:
                break
        assert "Coulomb friction on turn" in heard.get("gap/turn", ""), (heard, watched.poll())
    finally:
        watched.send_signal(2)
        printed, _ = watched.communicate(timeout=20)
        node.destroy_node()
        rclpy.try_shutdown(context=context)
    assert watched.returncode == 0, printed
    assert "gap: " in printed
