"""The tip keeps the cap of its regime in every motion mode, and the regime changes only where that is safe."""

import math

import numpy as np
import pytest
from law_bench import ROBOT, SETTINGS
from sher3_common.reasons import Reason
from sher3_common.samples import JointSample, TwistSample
from sher3_control.errors import SettingsError
from sher3_control.motion.controller import MotionController, MotionInput
from sher3_control.motion.ownership import Mode
from sher3_control.motion.speed_cap import Regime, parse_regime, speed_cap
from sher3_control.settings import ControlSettings
from sher3_kinematics import RobotKinematics

T, START = 2_000_000, 10**18
KINEMATICS = RobotKinematics(ROBOT)
POSTURES = [(0.0,) * 5, (0.004, -0.003, 0.002, 0.3, -0.008), (-0.005, 0.002, 0.004, -0.4, 0.01)]


class Bench:
    """A motion controller in a regime with an ideal robot."""

    def __init__(self, regime, q=(0.0,) * 5):
        self.motion = MotionController(ROBOT, SETTINGS.motion.model_copy(update={"regime": regime}))
        self.now, self.q, self.twist = START, q, (0.0,) * 6
        self.motion.cooperative_wants(False, START)

    def state(self):
        return MotionInput(self.now, True, self.now, self.q, self.now, self.twist)

    def tick(self):
        self.now += T
        out = self.motion.tick(self.state())
        speed = np.asarray(KINEMATICS.jacobian(np.array(self.q))) @ out.velocity
        self.q = tuple(q + 0.002 * v for q, v in zip(self.q, out.velocity, strict=True))
        return out, float(np.linalg.norm(speed[:3])), float(np.linalg.norm(speed[3:]))


def run(bench, mode, sample):
    """Stream commands of a velocity mode; return the largest speeds and the last output."""
    speeds = []
    for _ in range(100):
        bench.motion.command(mode, sample(bench.now), bench.state())
        out, linear, angular = bench.tick()
        speeds.append((linear, angular))
    return np.max(speeds, axis=0), out


@pytest.mark.parametrize("regime", ["near_tissue", "free"])
@pytest.mark.parametrize("q", POSTURES)
def test_velocity_modes_are_scaled_to_the_cap_and_keep_their_direction(regime, q):
    cap = speed_cap(SETTINGS.motion, Regime(regime))
    twist = (0.02, -0.01, 0.01, 0.2, 0.1, 0.0)
    (linear, angular), out = run(Bench(regime, q), Mode.SERVO_CV, lambda now: TwistSample(now, twist))
    assert out.limited_by == "tip speed"
    assert linear <= 1.002 * cap.linear and angular <= 1.002 * cap.angular
    assert linear > 0.9 * cap.linear or angular > 0.9 * cap.angular
    fast = JointSample(0, velocity=(0.01, 0.008, 0.005, 0.5, -0.01))
    (linear, angular), _ = run(Bench(regime, q), Mode.SERVO_JV, lambda now: fast._replace(stamp=now))
    assert linear <= 1.002 * cap.linear and angular <= 1.002 * cap.angular


@pytest.mark.parametrize("regime", ["near_tissue", "free"])
def test_cooperative_motion_keeps_the_cap(regime):
    bench = Bench(regime)
    bench.twist = (0.005, 0.0, 0.0, 0.0, 0.0, 0.0)
    bench.motion.tick(bench.state()._replace(twist=(0.0,) * 6))
    bench.motion.cooperative_wants(True, bench.now)
    speeds = [bench.tick()[1] for _ in range(50)]
    assert max(speeds) == pytest.approx(speed_cap(SETTINGS.motion, Regime(regime)).linear, rel=2e-3)


@pytest.mark.parametrize("regime", ["near_tissue", "free"])
def test_moves_are_planned_below_the_cap_and_arrive(regime):
    bench, goal = Bench(regime), (0.001, -0.0005, 0.0008, 0.05, 0.001)
    bench.motion.command(Mode.MOVE_JP, JointSample(bench.now, goal), bench.state())
    cap, speeds = speed_cap(SETTINGS.motion, Regime(regime)), []
    while bench.motion.busy:
        out, linear, angular = bench.tick()
        assert out.reason is Reason.MOVING
        speeds.append((linear / cap.linear, angular / cap.angular))
    assert 0.3 < np.max(speeds) < 1.0
    tolerance = [10.0 * actuator.load_encoder for actuator in ROBOT.actuators]
    assert np.all(np.abs(np.subtract(bench.q, goal)) <= tolerance)


def test_a_position_stream_faster_than_the_cap_stops_and_on_the_bench_goes():
    """Following it slowly would leave the commanded path; the bench is the contract's host law."""
    for regime, reason in (("near_tissue", Reason.TIP_SPEED), ("free", Reason.TIP_SPEED), ("bench", Reason.MOVING)):
        bench = Bench(regime)
        sample = JointSample(bench.now + T, (2e-4,) * 3 + (0.0, 0.0), (0.008,) * 3 + (0.0, 0.0))
        bench.motion.command(Mode.SERVO_JP, sample, bench.state())
        out, *_ = bench.tick()
        assert out.reason is reason and any(out.velocity) == (reason is Reason.MOVING)


def test_the_bench_has_no_cap_and_is_neither_entered_nor_left_while_running():
    assert speed_cap(SETTINGS.motion, Regime.BENCH) == (math.inf, math.inf)
    for text, present in (("bench", Regime.FREE), ("free", Regime.BENCH), ("fast", Regime.FREE)):
        with pytest.raises(SettingsError, match="regime cannot change"):
            parse_regime(text, present, moving=False)


def test_a_slower_regime_is_taken_at_once_a_faster_one_only_at_rest():
    assert parse_regime("near_tissue", Regime.FREE, moving=True) is Regime.NEAR_TISSUE
    assert parse_regime("free", Regime.NEAR_TISSUE, moving=False) is Regime.FREE
    with pytest.raises(SettingsError, match="in use"):
        parse_regime("free", Regime.NEAR_TISSUE, moving=True)


def test_caps_that_contradict_each_other_are_refused():
    with pytest.raises(SettingsError, match="near_speed"):
        ControlSettings.from_robot(ROBOT, {"motion": {"near_speed": 0.006}})
    with pytest.raises(SettingsError, match="heartbeat"):
        ControlSettings.from_robot(ROBOT, {"supervisor": {"heartbeat_limit": 0.015}})
