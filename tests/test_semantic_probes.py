"""Units, frames and signs from end to end, against arithmetic done by hand from the data sheets and the contract.

Each probe names the mutation it kills. What could be wrong at both ends of a wire alike, and so cancel, is compared
with bytes or numbers written out here; nothing here takes a factor from the robot file.
"""

import itertools
import math
import struct

import numpy as np
import pytest
from sher3_common.samples import JointSample
from sher3_control import ControlSettings, initial_state, step
from sher3_control.law.admittance import LawInput
from sher3_control.law.angles import roll_and_tilt
from sher3_control.law.parameters import law_parameters
from sher3_control.law.position_controller import position_command
from sher3_control.law.tool_compensation import contact_wrench, tip_rotation, wrench_at_tip
from sher3_control.motion.pose import tip_pose_sample
from sher3_control.motion.speed_cap import Regime, speed_cap
from sher3_control.settings import MotionSettings
from sher3_description import TOPICS, load_robot
from sher3_drivers.bus.frame import FRAME_SIZE, pack_frame
from sher3_drivers.bus.link import open_link
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.configuration import required_writes
from sher3_drivers.mock.rig import LockstepRig
from sher3_drivers.pedal.hid import REPORT, HidPedal
from sher3_drivers.sensor.netft import NetFtScale
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_kinematics import InverseVelocity, RobotKinematics
from sher3_kinematics.kernel import kernel_parameters
from sher3_runtime.codec.cdr import codec
from sher3_sim import Plant

ROBOT = load_robot()
KINEMATICS = RobotKinematics(ROBOT)
PARAMETERS = np.array(kernel_parameters(ROBOT))
CONTROL = ControlSettings.from_robot(ROBOT)
LAW = law_parameters(ROBOT, CONTROL)
POSTURES = [(0.0, 0.0, 0.0, 0.0, 0.0), (0.003, -0.002, 0.001, 0.5, 0.012), (-0.004, 0.0, 0.002, -0.6, -0.011)]
T = 0.002
_numbers = itertools.count()


def transform_by_hand(q):
    """T_bt of contract section 2, written out anew: spheres for the delta, the slider-crank by bisection."""
    r = math.sqrt(0.061855**2 - 0.02**2) - math.sqrt(0.0328**2 - 0.02**2)
    azimuth = [0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0]
    centres = np.array([[r * math.cos(a), r * math.sin(a), s] for a, s in zip(azimuth, q[:3], strict=True)])
    p = np.array([0.0, 0.0, 0.05])
    for _ in range(50):  # Newton on |p - c_k|^2 = L^2 from above
        p = p - np.linalg.solve(2.0 * (p - centres), ((p - centres) ** 2).sum(axis=1) - 0.064**2)
    crank, coupler, offset = 0.028, 0.070, 0.014
    slider = lambda th: crank * math.sin(th) + math.sqrt(coupler**2 - (offset - crank * math.cos(th)) ** 2)  # noqa: E731
    low, high = -1.2, 1.2
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slider(middle) - slider(0.0) < q[4] else (low, middle)
    theta, c, s = low, math.cos(q[3]), math.sin(q[3])
    rx = np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    ry = np.array([[math.cos(theta), 0, math.sin(theta)], [0, 1, 0], [-math.sin(theta), 0, math.cos(theta)]])
    position = p + np.array([0, 0, 0.060]) + rx @ (np.array([0.200, 0, 0.032]) + ry @ np.array([0.0, 0.0, -0.050]))
    return position, rx @ ry


@pytest.mark.parametrize("q", POSTURES)
def test_pose_is_that_of_the_contract(q):
    """Kills: roll or tilt in degrees, roll about another axis or the other way, tilt slider taken for its angle."""
    position, rotation = transform_by_hand(q)
    transform = KINEMATICS.transform_tip_to_base(q)
    assert transform[:3, 3] == pytest.approx(position, abs=1e-9)
    assert transform[:3, :3] == pytest.approx(rotation, abs=1e-9)


@pytest.mark.parametrize("q", POSTURES)
def test_the_law_sees_the_angles_of_the_tool(q):
    """Kills: roll or tilt of the other sign or in degrees, where the law turns the wrench into {b}."""
    _, rotation = transform_by_hand(q)
    by_hand = math.atan2(rotation[2, 1], rotation[1, 1]), math.atan2(rotation[0, 2], rotation[0, 0])
    assert roll_and_tilt(PARAMETERS, q[3], q[4]) == pytest.approx(by_hand, abs=1e-9)


def run_law(q, wrench, ticks=200, travel=1.0):
    """Twist after `ticks` of a steady wrench in {f}, the pedal released first; the law finds roll and tilt itself."""
    roll, tilt = roll_and_tilt(PARAMETERS, q[3], q[4])
    state, out = initial_state(), None
    for k in range(ticks):
        stamp = 10**18 + k * 2_000_000
        noisy = tuple(w + 1e-7 * (k % 7 - 3) for w in wrench)
        pedal = 0.0 if k < 2 else travel
        gains = (1.0, 0.001, 5.0, 0, (0.0,) * 6)
        state, out = step(
            state, LawInput(stamp, True, True, stamp, noisy, stamp, pedal, False, stamp, roll, tilt, *gains), LAW
        )
    return np.array(out.twist)


def sensor_reading(q, force, torque=(0.0, 0.0, 0.0)):
    """What the sensor reads in {f} of a force and torque in {b} on the tip, with the tool's weight (contract 3)."""
    _, rotation = transform_by_hand(q)
    f, t = rotation.T @ np.array(force), rotation.T @ np.array(torque)
    t = t + np.cross([0.0, 0.0, -0.030], f)  # the tip lies 30 mm below the sensor
    weight = rotation.T @ np.array([0.0, 0.0, -0.020 * 9.81])
    return (*(f + weight), *(t + np.cross([0.0, 0.0, -0.020], weight)))


@pytest.mark.parametrize("q", POSTURES)
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_hand_pushes_the_tip_where_it_pushes(q, axis, sign):
    """Through law, Jacobian, CAN bytes, drives and encoders: 1.1 N for 0.2 s moves the tip 0.2 mm along the push.

    Kills: any sign or transposed rotation from {f} to {b}; wrench of the tool instead of on the tool; gain per mN or
    per mm; a factor 1000 between m/s and counts that both ends share; an actuator order that differs.
    """
    force = [0.0, 0.0, 0.0]
    force[axis] = 1.1 * sign
    twist = run_law(q, sensor_reading(q, force), ticks=600)
    expected = np.zeros(3)
    expected[axis] = sign * 0.001 * (1.1 - 0.1)
    upright = not any(q)  # the dead band acts per axis of the tool, so a turned tool sees a little less of the force
    assert np.linalg.norm(twist[:3]) == pytest.approx(0.001, rel=1e-3 if upright else 0.12)
    assert along(twist[:3], expected) > (0.9999 if upright else 0.98) and np.abs(twist[3:]).max() < 1e-9
    rig = wire_rig()
    try:
        rig.plant.position = list(q)
        rig.enable()
        inverse, before, velocity = InverseVelocity(KINEMATICS), np.array(rig.plant.position), np.zeros(5)
        for _ in range(100):
            velocity = inverse(tuple(rig.plant.position), tuple(twist), tuple(velocity)).q_dot
            rig.tick(velocity.tolist())
        moved = transform_by_hand(rig.plant.position)[0] - transform_by_hand(before)[0]
    finally:
        rig.close()
    assert np.linalg.norm(moved) == pytest.approx(0.2e-3, rel=0.2)
    assert along(moved, expected) > (0.9999 if upright else 0.95)


def along(a, b):
    """The cosine between two vectors."""
    return a @ b / np.linalg.norm(a) / np.linalg.norm(b)


@pytest.mark.parametrize("q", POSTURES)
def test_the_weight_of_the_tool_moves_nothing(q):
    """Kills: gravity of the other sign or in the wrong frame (0.4 N, four dead bands), its torque about the origin."""
    assert not run_law(q, sensor_reading(q, (0.0, 0.0, 0.0))).any()


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_twist_of_the_hand_turns_the_tip_the_same_way(axis, sign):
    """10 mN m beyond a dead band of 2 turn by 5 (rad/s)/(N m): 0.04 rad/s. Kills: torque sign, N mm for N m."""
    torque = [0.0, 0.0, 0.0]
    torque[axis] = sign * 0.010
    twist = run_law(POSTURES[0], sensor_reading(POSTURES[0], (0.0, 0.0, 0.0), torque), ticks=400)
    assert twist[3 + axis] == pytest.approx(sign * 5.0 * 0.008, rel=1e-3)
    q_dot = InverseVelocity(KINEMATICS)(POSTURES[0], tuple(twist), (0.0,) * 5).q_dot
    assert q_dot[3 + axis] * sign > 0.0


def test_a_force_at_the_tip_is_no_torque_there():
    """Kills: the lever from sensor to tip of the other sign or length; it would be 60 N mm at 1 N."""
    reading = sensor_reading(POSTURES[1], (0.3, 0.7, -0.2))
    wrench = contact_wrench(reading, tip_rotation(*_angles(POSTURES[1])), 0.020, (0.0, 0.0, -0.020), (0.0,) * 6)
    assert np.abs(wrench_at_tip(wrench, (0.0, 0.0, 0.030))[3:]).max() < 1e-12


def _angles(q):
    _, rotation = transform_by_hand(q)
    return q[3], math.atan2(rotation[0, 2], rotation[0, 0])


# The wire, byte by byte.


def wire_rig():
    number = next(_numbers)
    return LockstepRig(ROBOT, default_settings(protected=False), lambda i: open_link(f"virtual:wire{number}-{i}"))


def host_frames(rig, command):
    """What the host put on the wire in the tick of a command: {can id: data}."""
    seen = {}

    def tap(channel, frames, now):
        for at in range(0, len(frames), FRAME_SIZE):
            frame = frames[at : at + FRAME_SIZE]
            seen[int.from_bytes(frame[:4], "little")] = frame[8 : 8 + frame[4]]
        return frames

    rig.mock.tamper_received = tap
    rig.tick(command)
    rig.tick(command)
    return seen


def test_velocity_on_the_wire_is_micro_revolutions_per_minute():
    """2 mm/s on a 2 mm screw is 60 rpm; 1 rad/s behind 1/100 is 954.93 rpm. Kills: mm/s, deg/s, rad/s of the motor."""
    rig = wire_rig()
    rig.enable()
    seen = host_frames(rig, [0.002, -0.002, 0.001, 1.0, 0.004])
    targets = [struct.unpack("<Hi", seen[0x200 + node])[1] for node in range(1, 6)]
    assert targets == [60_000_000, -60_000_000, 30_000_000, 954_929_659, 120_000_000]
    rig.close()


def test_the_drives_turn_what_the_wire_says():
    """Kills: a factor that host and mock share: 60 rpm of a 2 mm screw for 0.1 s is 0.2 mm."""
    rig = wire_rig()
    rig.enable()
    start = list(rig.plant.position)
    for _ in range(50):
        rig.tick([0.002, 0.0, 0.0, 0.5, 0.0])
    assert rig.plant.position[0] - start[0] == pytest.approx(0.002 * 49 * T, rel=0.02)
    assert rig.plant.position[3] - start[3] == pytest.approx(0.5 * 49 * T, rel=0.02)
    rig.close()


@pytest.mark.parametrize(
    ("axis", "counts", "position"),
    [
        (0, 4096, 1e-3),  # LA11: 4096 counts per mm
        (1, -4096, -1e-3),
        (4, 40960, 10e-3),
        (3, 65536, math.pi / 2.0),  # AksIM-2: 18 bit per turn at the output
        (3, -728, math.radians(-0.99976)),  # 728.18 counts per degree
    ],
)
def test_load_encoder_counts_are_those_of_the_data_sheets(axis, counts, position):
    """Kills: counts per um, a 2^17 or 2^19 ring, degrees, a sign. The bytes are written here, not by the mock."""
    rig = wire_rig()
    rig.enable()
    tpdo = pack_frame(od.TPDO_BASES[0] + axis + 1, struct.pack("<iHh", counts, 0x1237, 0))

    def forge(channel, frames, now):
        parts = [frames[k : k + FRAME_SIZE] for k in range(0, len(frames), FRAME_SIZE)]
        return b"".join(tpdo if part[:4] == tpdo[:4] else part for part in parts)

    rig.mock.tamper_frames = forge
    assert rig.tick().load_position[axis] == pytest.approx(position, rel=2e-5)
    rig.close()


def test_motor_counts_velocity_and_effort_of_a_forged_frame():
    """1 um and 31.4 urad a count, micro-rpm, rated/1000. Kills: motor and load swapped, N for rated/1000, sign."""
    rig = wire_rig()
    rig.enable()
    frames = {0: (-2500, 30_000_000, -250), 3: (1000, 954_929_659, 500)}

    def forge(channel, data, now):
        parts = [data[k : k + FRAME_SIZE] for k in range(0, len(data), FRAME_SIZE)]
        out = []
        for part in parts:
            can_id = int.from_bytes(part[:4], "little")
            for axis, (motor, demand, torque) in frames.items():
                if can_id == od.TPDO_BASES[0] + axis + 1:
                    part = pack_frame(can_id, struct.pack("<iHh", 0, 0x1237, torque))
                elif can_id == od.TPDO_BASES[1] + axis + 1:
                    part = pack_frame(can_id, struct.pack("<ii", motor, demand))
            out.append(part)
        return b"".join(out)

    rig.mock.tamper_frames = forge
    feedback = rig.tick()
    assert feedback.motor_position[0] == pytest.approx(-2.5e-3) and feedback.velocity_demand[0] == pytest.approx(0.001)
    assert feedback.effort[0] == pytest.approx(-0.250 * 80.0) and feedback.effort[3] == pytest.approx(0.5 * 2.0)
    assert feedback.motor_position[3] == pytest.approx(0.0314159265, rel=1e-6)
    assert feedback.velocity_demand[3] == pytest.approx(1.0, rel=1e-8)
    rig.close()


def test_heartbeat_times_are_milliseconds():
    """Kills: seconds or us in objects 1016 and 1017: 27 ms of node 127, 50 ms."""
    writes = dict(required_writes(1, AxisScale.from_actuator(ROBOT.actuators[0]), default_settings()))
    assert writes[od.HOST_HEARTBEAT] == 0x007F001B and writes[od.DRIVE_HEARTBEAT] == 50


def test_force_counts_are_per_newton_and_newton_millimetre():
    """Kills: N mm reported as N m, or the other way."""
    assert NetFtScale().to_wrench((1_000_000, 0, -500_000, 1_000_000, 0, 0)) == pytest.approx(
        (1.0, 0.0, -0.5, 0.001, 0.0, 0.0)
    )


@pytest.mark.parametrize(("raw", "travel"), [(0, 0.0), (32768, 0.5), (65535, 1.0)])
def test_pedal_travel_is_nought_to_one(raw, travel, tmp_path):
    """Kills: -1 to 1, percent, a pedal that moves the robot when it is up."""
    import os

    os.mkfifo(tmp_path / "js")
    pedal = HidPedal(str(tmp_path / "js"))
    with open(tmp_path / "js", "wb", buffering=0) as device:
        device.write(REPORT.pack(raw, 1, 1))
        assert pedal.read().travel == pytest.approx(travel, abs=1e-5)
    pedal.close()


def test_half_a_pedal_is_about_half_the_speed():
    """Kills: the pedal inverted or left out."""
    wrench = sensor_reading(POSTURES[0], (1.1, 0.0, 0.0))
    full, half = (run_law(POSTURES[0], wrench, 400, travel)[0] for travel in (1.0, 0.5))
    assert full == pytest.approx(0.001, rel=1e-3) and 0.35 < half / full < 0.55


# Time, control law, plant.


def test_stamps_are_nanoseconds():
    """Kills: us, a float of seconds, sec and nanosec swapped."""
    encode, decode = codec(TOPICS["servo_jv"].type, "", ("delta_1", "delta_2", "delta_3", "roll", "tilt"))
    data = encode(JointSample(1_500_000_007, None, (0.0,) * 5, None))
    assert struct.unpack_from("<iI", data, 4) == (1, 500_000_007)
    assert decode(data).stamp == 1_500_000_007
    assert LAW.period == 2_000_000 and LAW.wrench_age_limit == 10_000_000


def test_the_host_law_goes_towards_its_reference():
    """20 1/s times 0.1 mm is 2 mm/s. Kills: q - q_ref, gain per period."""
    velocity = position_command((1e-4, -1e-4, 0.0, 0.01, 0.0), (0.0,) * 5, (0.0,) * 5, 20.0, (0.0122,) * 5)
    assert velocity[:3] == pytest.approx((0.002, -0.002, 0.0)) and velocity[3] == 0.0122


def test_a_resting_plant_is_held_up_against_gravity():
    """The sliders together carry 1 kg: 9.81 N up. Kills: the sign of effort or gravity, kg for N."""
    reading = Plant(ROBOT).reset((0.0,) * 5)
    assert sum(reading.effort[:3]) == pytest.approx(9.81, abs=0.5)


def test_a_hand_on_the_tip_shows_in_effort_with_the_opposite_sign():
    """Pushing the tip down by 2 N, the drives push up by 2 N more. Kills: wrench by the tool instead of on it."""
    free, pushed = (Plant(ROBOT).reset((0.0,) * 5, (0.0, 0.0, f, 0.0, 0.0, 0.0)) for f in (0.0, -2.0))
    assert sum(pushed.effort[:3]) - sum(free.effort[:3]) == pytest.approx(2.0, abs=0.5)
    assert pushed.wrench[2] - free.wrench[2] == pytest.approx(-2.0, abs=0.05)


def test_quaternions_are_x_y_z_w():
    """A quarter turn of roll about x. Kills: w first, degrees."""
    orientation = tip_pose_sample_of((0.0, 0.0, 0.0, math.pi / 3.0, 0.0))
    assert orientation == pytest.approx((0.5, 0.0, 0.0, math.cos(math.pi / 6.0)), abs=1e-9)


def tip_pose_sample_of(q):
    return tip_pose_sample(PARAMETERS, q)[1]


def test_speed_caps_are_metres_per_second():
    """Near tissue no more than millimetres per second. Kills: mm/s taken for m/s."""
    cap = speed_cap(MotionSettings(), Regime.NEAR_TISSUE)
    assert 1e-5 < cap.linear < 5e-3 and 1e-3 < cap.angular < 0.5
