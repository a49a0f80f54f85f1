"""The three nodes in stepped time: cooperative motion, stops in the same tick, one owner, exact replay."""

import pytest
from control_graph import control_graph
from law_bench import ROBOT
from sher3_common.samples import DiagnosticSample, JointSample, TwistSample
from sher3_control.nodes.supervisor_node import OWN
from sher3_runtime.ports import ports
from std_srvs.srv import Trigger

pytestmark = pytest.mark.graph
T = 2_000_000
REST = (0.0,) * 5


def test_enable_press_push_moves_and_release_stops_in_the_same_tick():
    with control_graph() as g:
        g.press(force=(1.0, 0.0, 0.0))
        g.step(20)
        assert g.last("servo_jv").velocity == REST
        g.enable()
        g.step(20)
        g.until_reason("admittance/status", "NOT_REARMED")
        g.press(force=(1.0, 0.0, 0.0))
        g.step(100)
        g.until_mode("cooperative")
        assert g.last("servo_cv").twist[0] > 1e-4
        assert max(map(abs, g.last("servo_jv").velocity)) > 1e-4
        assert not g.probe.samples["setpoint_js"]
        g.robot.travel = 0.0
        stamp = g.step()
        assert (g.last("servo_cv").stamp, g.last("servo_jv").stamp) == (stamp, stamp)
        assert g.last("servo_jv").velocity == REST
        g.step(3)
        g.until_mode(None)


@pytest.mark.parametrize("silence", ["force", "travel"])
def test_silence_stops_within_the_age_limit_and_faults(silence):
    with control_graph() as g:
        g.enable()
        g.press(force=(1.0, 0.0, 0.0))
        g.step(100)
        setattr(g.robot, silence, None)
        moving = 0
        for _ in range(15):
            g.step()
            moving += any(g.last("servo_jv").velocity)
        limit = {"force": 0.010, "travel": 0.020}[silence]
        assert moving <= limit / 0.002
        g.step(60)
        g.until_state("FAULT")
        status = g.status("supervisor/status")
        assert status["first_fault"]["code"].endswith("_STALE")
        setattr(g.robot, silence, (1.0, 0.0, 0.0) if silence == "force" else 1.0)
        g.step(10)
        g.text("state_command", "enable")
        g.graph.until(lambda: g.status("supervisor/status")["refused"], "refusal")
        assert g.status("supervisor/status")["state"] == "FAULT"
        g.text("state_command", "disable")
        g.until_state("DISABLED")
        g.enable()
        g.step(30)
        assert g.last("servo_jv").velocity == REST
        g.press(force=(1.0, 0.0, 0.0))
        g.step(50)
        assert any(g.last("servo_jv").velocity)


def test_emergency_stop_faults_in_its_tick():
    with control_graph() as g:
        g.enable()
        g.press(force=(1.0, 0.0, 0.0))
        g.step(50)
        g.robot.button = 1
        g.step()
        assert g.last("servo_jv").velocity == REST
        g.until_state("FAULT")
        assert g.status("supervisor/status")["first_fault"]["code"] == "EMERGENCY_STOP"


@pytest.mark.parametrize("buttons", [(), (1, 0, 0)], ids=["none", "gamepad"])
def test_a_message_with_other_buttons_than_a_pedals_stops_and_is_named_for_what_it_is(buttons):
    """In the same tick; it is no emergency stop, which nobody pressed."""
    with control_graph() as g:
        g.enable()
        g.press(force=(1.0, 0.0, 0.0))
        g.step(50)
        g.robot.button = buttons
        g.step()
        assert g.last("servo_cv").twist == (0.0,) * 6
        g.until_state("FAULT")
        fault = g.status("supervisor/status")["first_fault"]
        assert (fault["code"], fault["value"], fault["unit"]) == ("PEDAL_INVALID", len(buttons), "buttons")
        assert "one axis, the travel, and one button" in fault["remedy"]


def test_the_robot_is_enabled_only_while_nothing_pulls_at_the_tool():
    with control_graph() as g:
        g.robot.force = (0.3, 0.0, 0.0)
        g.step(60)
        g.text("state_command", "enable")
        g.graph.until(lambda: g.status("supervisor/status")["refused"], "refusal")
        told = g.status("supervisor/status")
        assert told["state"] == "DISABLED"
        assert "FORCE_UNEXPLAINED: force sensor, force x 0.3" in told["refused"]["text"]
        assert "limit 0.05 N" in told["refused"]["text"] and "let go of the tool" in told["refused"]["text"]
        g.robot.force = (0.0, 0.0, 0.0)
        g.step(60)
        g.enable()


def test_tare_and_live_parameters_answer_over_the_graph():
    with control_graph() as g:
        g.enable()
        g.step(260)
        client = g.probe.create_client(Trigger, "admittance/tare")
        g.graph.until(client.service_is_ready, "service")
        for travel, good in ((1.0, False), (0.0, True)):
            g.robot.travel = travel
            g.step(3)
            future = client.call_async(Trigger.Request())
            g.graph.until(future.done, "answer")
            assert future.result().success == good, future.result().message
        assert g.admittance.live.version == 1
        g.text("admittance", "speed_scale 7")
        g.graph.until(lambda: g.status("admittance/status").get("refused", {}).get("value") == 7.0, "refusal")
        g.text("rcm", "here 0.018")
        assert g.kinematics.motion.velocity_modes.centre is not None
        g.text("admittance", "rcm off")
        g.graph.until(lambda: g.status("admittance/status")["refused"]["value"] == "rcm", "refusal")
        assert g.kinematics.motion.velocity_modes.centre is not None


def test_a_drive_fault_faults_and_its_reset_on_the_way_to_disabled_is_not_blocked():
    with control_graph() as g:
        g.enable()
        g.probe.send("diagnostics", DiagnosticSample(g.now, "motor_driver: drives", 2, "stopped: roll in FAULT"))
        g.until_state("FAULT")
        assert "roll in FAULT" in g.status("supervisor/status")["first_fault"]["source"]
        g.text("state_command", "disable")
        g.until_state("DISABLED")
        g.probe.send("diagnostics", DiagnosticSample(g.now, "motor_driver: drives", 2, "stopped: an old report"))
        g.probe.send("diagnostics", DiagnosticSample(g.now, "motor_driver: drives", 0, "DISABLED"))
        g.step(5)  # a zero is earned by what the sensor says without power
        g.text("state_command", "enable")
        g.until_state("ENABLED")


def test_servo_jp_for_the_tick_of_its_stamp_gives_the_host_law():
    with control_graph() as g:
        g.enable()
        start = g.step() + 5 * T
        for k in range(50):
            q = tuple(1e-5 * k for _ in range(5))
            g.probe.send("command/servo_jp", JointSample(start + k * T, q, (1e-3,) * 5))
        g.graph.settle()
        g.step(60)
        setpoints = {s.stamp: s for s in g.probe.samples["setpoint_js"]}
        measured = {s.stamp: s for s in g.probe.samples["measured_js"]}
        velocity = {s.stamp: s for s in g.probe.samples["servo_jv"]}
        for k in range(50):
            stamp = start + k * T
            assert setpoints[stamp].position == (1e-5 * k,) * 5
            expected = tuple(1e-3 + 20.0 * (1e-5 * k - q) for q in measured[stamp].position)
            assert velocity[stamp].velocity == expected
        g.step(15)
        g.until_mode(None)
        assert g.last("servo_jv").velocity == REST


def test_move_jp_reaches_its_goal_and_refuses_a_second_owner():
    with control_graph() as g:
        g.enable()
        goal = (0.002, -0.001, 0.0015, 0.02, 0.001)
        g.probe.send("command/move_jp", JointSample(g.now, goal))
        g.graph.settle()
        g.step(20)
        g.until_mode("move_jp")
        assert g.status("motion/status")["is_busy"]
        twists = len(g.probe.samples["servo_cv"])
        g.step(5)
        assert len(g.probe.samples["servo_cv"]) == twists
        g.probe.send("command/servo_cv", TwistSample(g.now, (1e-3, 0.0, 0.0, 0.0, 0.0, 0.0)))
        g.graph.settle()
        g.step()
        g.graph.until(lambda: g.status("motion/status")["refused"], "refusal")
        refused = g.status("motion/status")["refused"]
        assert refused["error"] == "OwnerConflict"
        assert "move_jp owns the robot" in refused["text"]
        g.press(force=(1.0, 0.0, 0.0))
        g.step(10)
        g.until_reason("admittance/status", "NOT_OWNER")
        for _ in range(400):
            g.step()
            if g.status("motion/status")["mode"] is None:
                break
        tolerance = [10 * a.load_encoder for a in ROBOT.actuators]
        assert all(abs(a - b) <= t for a, b, t in zip(g.robot.q, goal, tolerance, strict=True))
        g.step(30)
        assert g.last("servo_jv").velocity == REST


def test_a_second_publisher_of_a_command_is_refused():
    with control_graph() as g:
        other = g.graph.probe(sends=("command/servo_jv",))
        g.enable()
        other.send("command/servo_jv", JointSample(g.now, velocity=(1e-3,) * 5))
        g.graph.settle()
        g.step(2)
        g.graph.until(lambda: g.status("motion/status")["refused"], "refusal")
        assert "several publishers" in g.status("motion/status")["refused"]["text"]
        assert g.last("servo_jv").velocity == REST


def test_a_refusal_ends_when_such_a_command_is_taken():
    with control_graph() as g:
        g.step(5)
        still = JointSample(g.now, velocity=REST)
        g.probe.send("command/servo_jv", still)
        g.step(2)
        g.graph.until(lambda: g.status("motion/status")["refused"], "refusal")
        assert g.status("motion/status")["refused"]["command"] == "servo_jv"
        g.enable()
        g.probe.send("command/servo_jv", still._replace(stamp=g.now))
        g.graph.settle()
        g.step(2)
        g.graph.until(lambda: g.status("motion/status")["refused"] is None, "end of the refusal")


def test_a_second_publisher_of_a_stream_of_the_robots_own_is_a_fault():
    """Every topic of its own, here or with drives and a tracker; whether the twin ever speaks makes no difference."""
    for name in OWN:
        with control_graph() as g:
            if not any(name in ports(node).publishers for node in g.graph.nodes):
                g.graph.probe(sends=(name,))
            g.enable()
            g.press(force=(1.0, 0.0, 0.0))
            g.step(20)
            assert g.last("servo_jv").velocity != REST
            g.graph.probe(sends=(name,))
            g.step(20)
            status = g.status("supervisor/status")
            assert (status["state"], status["reason"]) == ("FAULT", "PUBLISHED_TWICE"), name
            assert status["first_fault"]["source"] == name
            assert g.last("servo_jv").velocity == REST


def test_diagnostics_show_what_the_law_and_the_modes_look_at_with_their_limits():
    with control_graph() as g:
        told = g.graph.probe("diagnostics")
        g.enable()
        g.press(force=(1.0, 0.0, 0.0))
        g.step(510)
        values = {sample.name: dict(sample.values) for sample in told.samples["diagnostics"]}
        law, modes = values["admittance: inputs"], values["kinematics: inputs"]
        for key in (
            "PEDAL_STALE pedal/measured [s]",
            "WRENCH_STALE force/measured_cf [s]",
            "JOINTS_STALE measured_js [s]",
        ):
            value, limit = map(float, law[key].split(" limit "))
            assert 0.0 <= value <= limit
        assert law["WRENCH_FROZEN force/measured_cf [samples]"].endswith("limit 6")
        assert float(modes["TIP_SPEED tip [m/s]"].split()[0]) > 1e-4 and modes["regime"] == "bench"
        state = values["supervisor: state"]
        assert state["EMERGENCY_STOP pedal/measured [pressed]"] == "0 limit 0" and state["reason"] == "enable"
        assert float(state["JOINTS_STALE measured_js [s]"].split()[0]) < 0.02
