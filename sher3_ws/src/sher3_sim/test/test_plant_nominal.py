"""The compiled nominal model against the contract's equations, integrated by scipy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics
from sher3_sim import InputError, Plant, excitation, nominal_parameters, simulate, simulate_arrays

ROBOT = load_robot()
PERIOD = ROBOT.control_period
KINEMATICS = RobotKinematics(ROBOT)


def motion(n, amplitude=1e-3, frequency=1.0):
    t = np.arange(n) * PERIOD
    return np.outer(amplitude * (1 - np.cos(2 * np.pi * frequency * t)), [1.0, -0.7, 0.4, 40.0, 0.8])


def potential(q):
    """Gravity potential as the contract words it: platform by moving_mass only, roll and tilt by their masses."""
    arm = ROBOT.arm
    transform = KINEMATICS.transform_tip_to_base(np.array([0.0, 0.0, 0.0, q[3], q[4]]))[:3, :3]
    roll = np.array([[1, 0, 0], [0, np.cos(q[3]), -np.sin(q[3])], [0, np.sin(q[3]), np.cos(q[3])]])
    roll_height = (roll @ np.array(arm.roll_com))[2]
    tilt_height = (roll @ np.array([arm.d2, 0, arm.d3]) + transform @ np.array(arm.tilt_com))[2]
    platform = KINEMATICS.transform_tip_to_base(np.array([*q[:3], 0.0, 0.0]))[2, 3]
    return 9.81 * (ROBOT.delta.moving_mass * platform + arm.roll_mass * roll_height + arm.tilt_mass * tilt_height)


def load(q, wrench):
    step = 1e-6
    gravity = [(potential(q + step * e) - potential(q - step * e)) / (2 * step) for e in np.eye(5)]
    return np.array(gravity) - KINEMATICS.jacobian(q).T @ wrench


def reference(command, start, wrench):
    """Positions, velocities and forces at the ticks under a held demand, by an adaptive integrator."""
    names = ("kp", "ki", "limit")
    kp, ki, limit = (np.array([getattr(a.drive, name) for a in ROBOT.actuators]) for name in names)
    mass = np.array([a.mass for a in ROBOT.actuators])
    viscous = np.array([a.viscous for a in ROBOT.actuators])
    state = np.concatenate([start, np.zeros(5), load(start, wrench) / ki])
    forces, positions = [], []
    demand = np.zeros(5)
    for row in command:
        force = np.clip(kp * (demand - state[5:10]) + ki * state[10:], -limit, limit)
        forces.append(force)
        positions.append(state[:5])
        demand = row

        g = load(state[:5] + state[5:10] * PERIOD / 2, wrench)

        def rate(_, x, demand=demand, g=g):
            wanted = kp * (demand - x[5:10]) + ki * x[10:]
            force = np.clip(wanted, -limit, limit)
            error = demand - x[5:10]
            frozen = (wanted != force) & (wanted * error > 0)
            return np.concatenate([x[5:10], (force - viscous * x[5:10] - g) / mass, np.where(frozen, 0.0, error)])

        state = solve_ivp(rate, (0, PERIOD), state, rtol=1e-9, atol=1e-13, max_step=PERIOD / 8).y[:, -1]
    return np.array(positions), np.array(forces)


def test_matches_the_contracts_equations():
    n = 120
    rng = np.random.default_rng(3)
    command = np.cumsum(rng.normal(size=(n, 5)), axis=0) * [4e-4, 4e-4, 4e-4, 0.5, 4e-4]
    start = np.array([0.002, -0.001, 0.0015, 0.2, 0.003])
    wrench = np.array([0.5, -0.3, 0.8, 0.01, 0.0, -0.02])
    positions, forces = reference(command, start, wrench)
    drive = excitation(np.tile(start, (n, 1)), None, np.tile(wrench, (n, 1)), command=command, period=PERIOD)
    _, out = simulate_arrays(nominal_parameters(ROBOT).without_noise(), drive)
    assert np.abs(forces[:, 3]).max() == pytest.approx(5.0)  # the roll drive saturates on the way
    assert np.abs(out["motor"] - positions)[:, [0, 1, 2, 4]].max() < 1e-10
    assert np.abs(out["effort"] - forces)[:, [0, 1, 2, 4]].max() < 1e-5
    assert np.abs(out["motor"] - positions)[:, 3].max() < 2e-5


def test_nominal_axis_is_exact_in_one_step_per_period():
    drive = excitation(motion(400), period=PERIOD)
    p = nominal_parameters(ROBOT).without_noise()
    p.substeps = 64
    _, fine = simulate_arrays(p, drive)
    p.substeps = 1
    _, coarse = simulate_arrays(p, drive)
    assert np.abs(fine["motor"] - coarse["motor"]).max() < 1e-10
    assert np.abs(fine["effort"] - coarse["effort"]).max() < 1e-6


def test_run_starts_at_rest_held_by_the_drives():
    start = np.array([0.002, -0.001, 0.0015, 0.2, 0.003])
    wrench = np.array([0.5, -0.3, 0.8, 0.0, 0.0, 0.0])
    run = simulate(ROBOT, np.tile(start, (50, 1)), np.tile(wrench, (50, 1)))
    drives = run["drives/measured_js"]
    counts = [a.motor_encoder for a in ROBOT.actuators]
    assert np.all(np.abs(drives.position - start) <= 0.5001 * np.array(counts))
    assert np.allclose(drives.effort.mean(axis=0), load(start, wrench), atol=[0.1, 0.1, 0.1, 0.004, 0.1])
    assert np.all(drives.velocity[0] == 0) and np.all(run["drives/setpoint_jv"].velocity[0] == 0)


def test_sensor_conventions():
    run = simulate(ROBOT, motion(500), seed=4)
    command, echo = run["servo_jv"].velocity, run["drives/setpoint_jv"].velocity
    drives, load_side = run["drives/measured_js"], run["measured_js"]
    assert np.allclose(echo[1:], command[:-1], rtol=0, atol=1e-15)
    goal = run["setpoint_js"]
    limits = np.array([a.limits.velocity for a in ROBOT.actuators])
    law = np.clip(goal.velocity + ROBOT.position_gain * (goal.position - load_side.position), -limits, limits)
    assert np.array_equal(command, law)
    assert np.array_equal(drives.velocity[1:], np.diff(drives.position, axis=0) / PERIOD)
    for i, a in enumerate(ROBOT.actuators):
        for reading, count in (
            (drives.position[:, i], a.motor_encoder),
            (load_side.position[:, i], a.load_encoder),
            (drives.effort[:, i], a.drive.rated / 1000),
        ):
            assert np.abs(reading / count - np.round(reading / count)).max() < 1e-6
    assert len(run["tracker/measured_cp"]) == 100
    assert len(run["temperature"]) == 1


def test_force_sensor_reads_contact_and_tool_weight():
    q = np.array([0.001, 0.0, 0.002, 0.3, -0.004])
    wrench = np.array([1.0, -0.5, 0.7, 0.01, 0.02, -0.005])
    drive = excitation(np.tile(q, (2, 1)), None, np.tile(wrench, (2, 1)), period=PERIOD)
    _, out = simulate_arrays(nominal_parameters(ROBOT).without_noise(), drive)
    sensor = ROBOT.force_sensor
    rotation = KINEMATICS.transform_tip_to_base(q)[:3, :3]
    weight = rotation.T @ [0, 0, -sensor.tool_mass * 9.81]
    lever = rotation @ -np.array(sensor.position)  # from {f} to the tip
    moment = rotation.T @ (wrench[3:] + np.cross(lever, wrench[:3])) + np.cross(sensor.tool_com, weight)
    expected = np.concatenate([rotation.T @ wrench[:3] + weight, moment])
    assert np.allclose(out["wrench"][0], expected, atol=1e-6)


def test_live_plant_is_the_batch():
    goal, wrench = motion(200), np.zeros((200, 6))
    wrench[50:, 1] = 0.4
    run = simulate(ROBOT, goal, wrench, seed=7)
    plant = Plant(ROBOT, seed=7)
    first = plant.reset(goal[0], wrench[0])
    assert np.array_equal(first.effort, run["drives/measured_js"].effort[0])
    for k in range(199):
        reading = plant.step(run["servo_jv"].velocity[k], wrench[k + 1])
    assert np.array_equal(reading.load_position, run["measured_js"].position[-1])
    assert np.array_equal(reading.motor_velocity, run["drives/measured_js"].velocity[-1])
    assert np.array_equal(reading.wrench[:3], run["force/measured_cf"].force[-1])


def test_same_seed_same_run_other_seed_other_noise():
    one, same, other = (simulate(ROBOT, motion(100), seed=s)["drives/measured_js"].effort for s in (1, 1, 2))
    assert np.array_equal(one, same) and not np.array_equal(one, other)


@pytest.mark.parametrize(
    "bad",
    [np.zeros(4), [0, 0, np.nan, 0, 0], [0, 0, np.inf, 0, 0], [0, 0, None, 0, 0], ["a"] * 5, [10**400] * 5, None],
)
def test_bad_command_moves_nothing(bad):
    plant = Plant(ROBOT)
    before = plant.step(np.zeros(5))
    with pytest.raises(InputError):
        plant.step(bad)
    with pytest.raises(InputError):
        plant.step(np.zeros(5), [np.nan] * 6)
    assert np.allclose(plant.step(np.zeros(5)).load_position, before.load_position, atol=1e-6)


def test_bad_setpoints_are_refused():
    with pytest.raises(InputError, match="at least two"):
        simulate(ROBOT, np.zeros((1, 5)))
    with pytest.raises(InputError, match="shape"):
        simulate(ROBOT, np.zeros((10, 4)))
    with pytest.raises(InputError, match="finite"):
        simulate(ROBOT, np.full((10, 5), np.nan))
