"""The motion modes without ROS: admission, liveness, the host law, one owner, and no motion from garbage."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from law_bench import ROBOT, SETTINGS
from sher3_common import Sher3Error
from sher3_common.reasons import Reason
from sher3_common.samples import JointSample, PoseSample, TwistSample
from sher3_control.errors import CommandRejected, OwnerConflict, SettingsError
from sher3_control.motion.controller import MotionController, MotionInput
from sher3_control.motion.ownership import Mode
from sher3_control.motion.pose import tip_pose_sample, tip_twist_sample
from sher3_control.motion.rcm_command import apply_rcm_command
from sher3_kinematics.kernel import kernel_parameters

T = 2_000_000
START = 1_000_000_000_000_000_000
REST = (0.0,) * 5
NO_TWIST = (0.0,) * 6
PARAMETERS = np.array(kernel_parameters(ROBOT))
PUSH = (1e-3, 0.0, 0.0, 0.0, 0.0, 0.0)


class Bench:
    """A motion controller and an ideal robot; `tick(**changes)` starts from healthy inputs."""

    def __init__(self, regime="bench"):
        self.motion = MotionController(ROBOT, SETTINGS.motion.model_copy(update={"regime": regime}))
        self.k, self.q = 0, REST
        self.motion.cooperative_wants(False, START)

    @property
    def now(self):
        return START + self.k * T

    def state(self, **changes):
        return MotionInput(self.now, True, self.now, self.q, self.now, NO_TWIST)._replace(**changes)

    def tick(self, **changes):
        self.k += 1
        out = self.motion.tick(self.state(**changes))
        self.q = tuple(q + 0.002 * v for q, v in zip(self.q, out.velocity, strict=True))
        return out

    def command(self, mode, sample, publishers=1, **changes):
        self.motion.command(mode, sample, self.state(**changes), publishers)


def joints(bench, position=None, velocity=None, ahead=0):
    return JointSample(bench.now + ahead, position, velocity)


def test_servo_jp_is_the_host_law_exactly():
    bench = Bench()
    reference = (1e-4, -1e-4, 5e-5, 1e-3, 2e-5)
    bench.command(Mode.SERVO_JP, joints(bench, reference, (1e-3,) * 5, ahead=T))
    out = bench.tick()
    limits = [a.limits.velocity for a in ROBOT.actuators]
    expected = [min(max(1e-3 + 20.0 * (r - 0.0), -v), v) for r, v in zip(reference, limits, strict=True)]
    assert list(out.velocity) == expected
    assert out.setpoint == (reference, (1e-3,) * 5)
    assert bench.tick().setpoint == (reference, REST)


def test_an_early_servo_jp_holds_where_it_was_sent():
    bench = Bench()
    bench.command(Mode.SERVO_JP, joints(bench, (1e-4,) * 5, ahead=5 * T))
    assert bench.tick().setpoint == (REST, REST)
    assert bench.motion.ownership.owner is Mode.SERVO_JP


SAMPLES = {
    Mode.SERVO_JP: lambda b: joints(b, (1e-5,) * 5),
    Mode.SERVO_JV: lambda b: joints(b, velocity=(1e-3,) * 5),
    Mode.SERVO_CV: lambda b: TwistSample(b.now, PUSH),
    Mode.SERVO_CP: lambda b: PoseSample(b.now, *tip_pose_sample(PARAMETERS, (1e-5,) * 5)),
    Mode.MOVE_JP: lambda b: joints(b, (1e-3,) * 5),
    Mode.MOVE_CP: lambda b: PoseSample(b.now, *tip_pose_sample(PARAMETERS, (1e-3, 0.0, 0.0, 0.02, 0.001))),
}
SERVOS = [mode for mode in SAMPLES if mode.value.startswith("servo")]


@pytest.mark.parametrize("mode", SAMPLES)
def test_every_mode_moves_the_robot_and_is_the_only_owner(mode):
    bench = Bench()
    bench.command(mode, SAMPLES[mode](bench))
    assert any(any(bench.tick().velocity) for _ in range(5))
    for other in SAMPLES:
        if other is not mode:
            with pytest.raises(OwnerConflict) as caught:
                bench.command(other, SAMPLES[other](bench))
            assert caught.value.owner == mode.value
    bench.motion.cooperative_wants(True, bench.now)
    assert bench.motion.ownership.owner is mode


@pytest.mark.parametrize("mode", SERVOS)
def test_a_servo_stream_that_ends_stops_the_robot_and_frees_it(mode):
    bench = Bench()
    bench.command(mode, SAMPLES[mode](bench))
    outputs = [bench.tick() for _ in range(15)]
    moving = sum(any(out.velocity) for out in outputs)
    assert 0 < moving <= SETTINGS.motion.servo_timeout / 0.002
    assert Reason.COMMAND_STALE in [out.reason for out in outputs]
    assert bench.motion.ownership.owner is None


@pytest.mark.parametrize("mode", [Mode.MOVE_JP, Mode.MOVE_CP])
def test_a_move_arrives_and_hands_the_robot_back(mode):
    bench = Bench()
    sample = SAMPLES[mode](bench)
    bench.command(mode, sample)
    assert bench.motion.busy
    with pytest.raises(CommandRejected, match="busy"):
        bench.command(mode, SAMPLES[mode](bench))
    for _ in range(3000):
        bench.tick()
        if bench.motion.ownership.owner is None:
            break
    goal = (1e-3,) * 5 if mode is Mode.MOVE_JP else (1e-3, 0.0, 0.0, 0.02, 0.001)
    tolerance = [SETTINGS.motion.settle_factor * a.load_encoder for a in ROBOT.actuators]
    assert all(abs(a - b) <= t for a, b, t in zip(bench.q, goal, tolerance, strict=True))
    assert not bench.motion.busy
    assert bench.tick().velocity == REST


@pytest.mark.parametrize(
    ("sample", "word"),
    [
        (lambda b: joints(b, (math.nan, 0.0, 0.0, 0.0, 0.0)), "finite"),
        (lambda b: joints(b, (0.0,) * 4), "needs 5"),
        (lambda b: joints(b), "needs 5"),
        (lambda b: joints(b, (1e-3, 0.0, 0.0, 0.0, 0.0)), "step too large"),
        (lambda b: joints(b, (0.05, 0.0, 0.0, 0.0, 0.0)), "beyond its travel"),
        (lambda b: joints(b, REST, ahead=-20 * T), "stale"),
        (lambda b: joints(b, REST, ahead=1000 * T), "too early"),
        (lambda b: JointSample(0, REST), "unstamped"),
        (lambda b: joints(b, REST, (math.inf,) * 5), "finite"),
    ],
)
def test_servo_jp_refuses_what_it_cannot_follow(sample, word):
    bench = Bench()
    with pytest.raises(CommandRejected, match=word):
        bench.command(Mode.SERVO_JP, sample(bench))
    assert bench.motion.ownership.owner is None
    assert bench.tick().velocity == REST


def test_commands_out_of_order_are_refused_and_leave_the_stream_alone():
    bench = Bench()
    bench.command(Mode.SERVO_JP, joints(bench, (1e-5,) * 5, ahead=2 * T))
    with pytest.raises(CommandRejected, match="out of order"):
        bench.command(Mode.SERVO_JP, joints(bench, (2e-5,) * 5, ahead=T))
    bench.tick()
    assert bench.tick().setpoint[0] == (1e-5,) * 5


def test_goals_out_of_reach_are_refused():
    bench = Bench()
    for goal in ((0.05, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.9, 0.0), (0.0, 0.0, 0.0, 0.0, 0.027)):
        with pytest.raises(Sher3Error):
            bench.command(Mode.MOVE_JP, joints(bench, goal))
    with pytest.raises(Sher3Error):
        bench.command(Mode.MOVE_JP, joints(bench, (0.038, -0.038, -0.038, 0.0, 0.0)))
    with pytest.raises(Sher3Error):
        bench.command(Mode.MOVE_CP, PoseSample(bench.now, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)))
    with pytest.raises(CommandRejected, match="quaternion"):
        bench.command(Mode.MOVE_CP, PoseSample(bench.now, (0.2, 0.0, 0.097), (0.0, 0.0, 0.0, 2.0)))
    assert bench.motion.ownership.owner is None


def test_nothing_is_accepted_unless_enabled_with_joints_and_one_publisher():
    bench = Bench()
    with pytest.raises(CommandRejected, match="not ENABLED"):
        bench.command(Mode.SERVO_JV, SAMPLES[Mode.SERVO_JV](bench), enabled=False)
    with pytest.raises(CommandRejected, match="JOINTS_STALE"):
        bench.command(Mode.SERVO_JV, SAMPLES[Mode.SERVO_JV](bench), joints_stamp=bench.now - 20 * T)
    with pytest.raises(OwnerConflict, match="several publishers"):
        bench.command(Mode.SERVO_JV, SAMPLES[Mode.SERVO_JV](bench), publishers=2)


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"enabled": False}, Reason.NOT_ENABLED),
        ({"joints_stamp": START - 10**9}, Reason.JOINTS_STALE),
        ({"joints_stamp": -1}, Reason.JOINTS_MISSING),
        ({"q": (math.nan, 0.0, 0.0, 0.0, 0.0)}, Reason.JOINTS_NOT_FINITE),
        ({"q": ()}, Reason.JOINTS_NOT_FINITE),
        ({"joints_stamp": START + 10**9}, Reason.CLOCK),
    ],
)
def test_bad_joints_stop_every_mode_at_once(changes, reason):
    for mode, sample in SAMPLES.items():
        bench = Bench()
        bench.command(mode, sample(bench))
        for _ in range(3):
            bench.tick()
        out = bench.tick(**changes)
        assert (out.velocity, out.reason, out.setpoint) == (REST, reason, None)
        assert bench.motion.ownership.owner is None
        assert bench.tick().velocity == REST


def test_cooperative_motion_resumes_only_after_the_law_was_seen_at_rest():
    bench = Bench()
    bench.motion.cooperative_wants(True, bench.now)
    assert any(bench.tick(twist=PUSH).velocity)
    assert bench.tick(twist=PUSH, joints_stamp=-1).reason is Reason.JOINTS_MISSING
    assert bench.tick(twist=PUSH).reason is Reason.NOT_REARMED
    bench.motion.cooperative_wants(True, bench.now)
    assert bench.tick(twist=PUSH).velocity == REST
    bench.motion.cooperative_wants(False, bench.now)
    bench.motion.cooperative_wants(True, bench.now)
    assert any(bench.tick(twist=PUSH).velocity)
    assert bench.tick(twist=(math.nan,) * 6).reason is Reason.COMMAND_NOT_FINITE
    assert bench.tick(twist_stamp=bench.now - 20 * T).reason is Reason.COMMAND_STALE


def test_velocity_modes_keep_the_limits_and_stop_before_the_ends():
    bench = Bench()
    upper = np.array([a.limits.upper for a in ROBOT.actuators])
    limits = np.array([a.limits.velocity for a in ROBOT.actuators])
    wanted = (1.0, 1.0, 1.0, 0.0, 0.0)
    for _ in range(2500):
        bench.command(Mode.SERVO_JV, joints(bench, velocity=wanted, ahead=T))
        out = bench.tick()
        assert np.all(np.abs(out.velocity) <= limits * (1 + 1e-12))
        assert np.all(np.array(bench.q) <= upper)
    assert bench.q[0] == pytest.approx(upper[0], abs=1e-4)


number = st.one_of(st.floats(), st.sampled_from([math.nan, math.inf, -math.inf, 1e300, 0.0]))
numbers = st.lists(number, max_size=7).map(tuple)


@given(st.sampled_from(list(SAMPLES)), numbers, numbers, st.integers(-(10**12), 10**12))
@settings(deadline=None, max_examples=200)
def test_garbage_is_refused_or_stays_within_the_limits(mode, first, second, offset):
    bench = Bench()
    stamp = bench.now + offset
    if mode in (Mode.SERVO_CP, Mode.MOVE_CP):
        sample = PoseSample(stamp, first, second)
    elif mode is Mode.SERVO_CV:
        sample = TwistSample(stamp, first)
    else:
        sample = JointSample(stamp, first, second)
    try:
        bench.command(mode, sample)
    except Sher3Error:
        assert bench.motion.ownership.owner is None
    for _ in range(3):
        out = bench.tick()
        for v, actuator in zip(out.velocity, ROBOT.actuators, strict=True):
            assert abs(v) <= actuator.limits.velocity * (1 + 1e-12)


def test_remote_centre_commands():
    motion = Bench().motion
    apply_rcm_command(motion, "here 0.018", REST)
    assert motion.velocity_modes.centre is not None
    apply_rcm_command(motion, "off", REST)
    assert motion.velocity_modes.centre is None
    for text in ("", "here", "here x", "here 3", "1 2", "0.2 0 0.5 0.1", "1 1 1"):
        with pytest.raises(SettingsError):
            apply_rcm_command(motion, text, REST)
    with pytest.raises(SettingsError, match="no joint positions"):
        apply_rcm_command(motion, "here 0.018", ())
    motion.cooperative_wants(True, START)
    with pytest.raises(SettingsError, match="pedal"):
        apply_rcm_command(motion, "off", REST)


@pytest.mark.parametrize("centre", [False, True])
def test_where_the_kinematics_fail_the_robot_stops_and_says_so(centre):
    bench = Bench()
    if centre:
        apply_rcm_command(bench.motion, "here 0.018", REST)
    bench.motion.cooperative_wants(True, bench.now)
    out = bench.tick(twist=PUSH, q=(0.0, 0.0, 0.0, 0.0, 0.03))
    assert out.velocity == REST
    assert out.reason in ((Reason.SINGULAR, Reason.OFF_CENTRE) if centre else (Reason.SINGULAR,))
    assert bench.tick(twist=PUSH).reason is Reason.NOT_REARMED


def test_the_twist_of_the_tip_is_what_its_pose_changes_by():
    q, qd, dt = (1e-3, -5e-4, 2e-4, 0.03, 1e-3), (1e-3, 2e-3, -1e-3, 0.05, 1e-3), 1e-6
    behind, before = (
        np.array(tip_pose_sample(PARAMETERS, tuple(np.array(q) + s * dt * np.array(qd)))[0]) for s in (1.0, -1.0)
    )
    assert tip_twist_sample(PARAMETERS, q, qd)[:3] == pytest.approx((behind - before) / (2 * dt), rel=1e-5)
