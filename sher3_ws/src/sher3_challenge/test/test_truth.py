"""A truth plant without faults is the nominal robot of the contract, and repeats scatter below the floor."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from sher3_challenge.oracle import nominal as contract
from sher3_challenge.oracle.oracle import excess, floors, stage_residuals
from sher3_challenge.plants.lumped.hysteresis import ELEMENTS, REACH, drag_anchors, play_offset, slip_state
from sher3_challenge.plants.lumped.mechanism import link_forces, load_forces, solve_platform, tilt_angle
from sher3_challenge.plants.lumped.plant import LumpedPlant as Plant
from sher3_challenge.plants.lumped.robot import nominal
from sher3_challenge.plants.plant import Climate, RunPlan
from sher3_challenge.plants.registry import truth_plant
from sher3_description import load_robot
from sher3_gap.excitation import excite

ROBOT = load_robot()
CLIMATE = Climate(22.0, 0.0, 100.0, 10**18)
EXACT = Plant(ROBOT, 0, (), CLIMATE, built=False)
PLANTS = {name: truth_plant(name) for name in ("lumped", "tables")}


def plan(label, seed=1, **kwargs):
    return RunPlan(excite(label, ROBOT, **kwargs), 0, 10**18, seed)


@pytest.fixture(scope="module", params=PLANTS)
def jumping(request):
    exact = PLANTS[request.param].make(ROBOT, 0, (), CLIMATE, built=False)
    return exact.run(plan("steps", posture="p1", duration=2.0, set_point_jumps=True), ideal=True)


def test_mechanism_agrees_with_the_closed_form():
    rng = np.random.default_rng(3)
    q = rng.uniform(-1, 1, (40, 5)) * [4e-3, 4e-3, 4e-3, 0.4, 8e-3]
    g = nominal(ROBOT).geometry
    pose = np.array([0, 0, 0.05, 0, 0, 0.0])
    force = np.array([0.3, -1.1, 0.7])
    tips = contract.tip_jacobian(ROBOT, q).transpose(0, 2, 1) @ force
    for k in range(len(q)):
        gravity, external = load_forces(g, q[k], pose, force)
        np.testing.assert_allclose(pose[:3], contract.platform_centre(ROBOT, q[k : k + 1])[0], atol=1e-12)
        np.testing.assert_allclose(gravity, contract.gravity(ROBOT, q[k : k + 1])[0], atol=3e-7)
        np.testing.assert_allclose(external, tips[k], atol=1e-7)
        assert tilt_angle(g, q[k, 4], 0.0)[0] == pytest.approx(contract.tilt_angle(ROBOT, q[k, 4:])[0], abs=1e-12)


def test_a_long_link_turns_the_platform():
    g = nominal(ROBOT).geometry
    g.link[0] += 1e-5
    pose = np.array([0, 0, 0.05, 0, 0, 0.0])
    solve_platform(g, np.zeros(3), g.link, pose)
    assert np.abs(pose[3:]).max() > 5e-5
    gap = np.array([np.linalg.norm(v) for v in _links(g, pose)]) - g.link
    np.testing.assert_allclose(gap, 0, atol=1e-12)


def _links(g, pose):
    from sher3_challenge.plants.lumped.mechanism import rotation

    turn = rotation(pose[3:])
    return [pose[:3] + turn @ g.platform_ball[i] - g.rail_ball[i] for i in range(6)]


def test_links_carry_the_platform():
    g = nominal(ROBOT).geometry
    pose = np.array([0, 0, 0.05, 0, 0, 0.0])
    solve_platform(g, np.zeros(3), g.link, pose)
    tension = link_forces(g, pose, np.zeros(3), np.array([0, 0, -9.81]), np.zeros(3))
    np.testing.assert_allclose(tension, tension[0], rtol=1e-9)
    lift = -tension[0] * 6 * pose[2] / ROBOT.delta.link_length  # all links lean alike and push up
    assert lift == pytest.approx(9.81, rel=1e-9)


def test_closed_loop_agrees_with_an_independent_integration(jumping):
    """Contract section 3 for one axis, by an adaptive stiff integrator, tick by tick from the recorded command."""
    j = 0
    actuator = ROBOT.actuators[j]
    drive, period = actuator.drive, ROBOT.control_period
    command = jumping["servo_jv"].velocity[:, j]
    motor = jumping["drives/measured_js"].position
    gravity = contract.gravity(ROBOT, motor)[:, j]

    def rates(t, y, demand, g0, slope):
        _, v, xi = y
        error = demand - v
        raw = drive.kp * error + drive.ki * xi
        force = min(drive.limit, max(-drive.limit, raw))
        held = abs(raw) > drive.limit and error * raw > 0
        return [v, (force - actuator.viscous * v - g0 - slope * t) / actuator.mass, 0.0 if held else error]

    y = np.array([motor[0, j], 0.0, gravity[0] / drive.ki])
    positions, efforts, demand = [y[0]], [gravity[0]], 0.0
    for k in range(400):
        demand = command[k]
        slope = (gravity[k + 1] - gravity[k]) / period
        answer = solve_ivp(rates, (0, period), y, "LSODA", args=(demand, gravity[k], slope), rtol=1e-10, atol=1e-13)
        y = answer.y[:, -1]
        positions.append(y[0])
        efforts.append(drive.kp * (demand - y[1]) + drive.ki * y[2])
    assert np.abs(command[:400]).max() > 2e-3
    np.testing.assert_allclose(motor[:401, j], positions, atol=6e-9)
    np.testing.assert_allclose(jumping["drives/measured_js"].effort[:401, j], efforts, atol=2e-3)


def test_start_is_at_rest_and_exact_stages_are_exact(jumping):
    echo, command = jumping["drives/setpoint_jv"].velocity, jumping["servo_jv"].velocity
    assert not echo[0].any()
    np.testing.assert_array_equal(echo[1:], command[:-1])
    q = jumping["drives/measured_js"].position
    np.testing.assert_allclose(q[0], jumping["setpoint_js"].position[0], atol=1e-15)
    residuals = stage_residuals(jumping, ROBOT)
    assert max(np.abs(r).max() for key, r in residuals.items() if key.startswith("controller")) == 0.0
    assert max(np.abs(r).max() for key, r in residuals.items() if key.startswith("transmission")) == 0.0
    assert np.abs(residuals["mechanism/tip"]).max() < 1e-12


@pytest.mark.parametrize("name", PLANTS)
def test_agrees_with_the_simulator(name):
    """Two plants written independently from the contract differ by less than its noise."""
    from sher3_sim import simulate

    e = excite("steps", ROBOT, posture="p2", duration=3.0, set_point_jumps=True)
    mine = PLANTS[name].make(ROBOT, 0, (), CLIMATE, built=False).run(RunPlan(e, 0, 10**18, 1), ideal=True)
    theirs = simulate(ROBOT, e.position, setpoint_velocity=e.velocity)
    count = np.array([a.motor_encoder for a in ROBOT.actuators])
    noise = 0.002 * np.array([a.drive.rated for a in ROBOT.actuators])
    mine, theirs = mine["drives/measured_js"], theirs["drives/measured_js"]
    assert np.all(np.abs(theirs.position - mine.position).max(axis=0) < 1.0 * count)  # rounding is half of it
    force = theirs.effort - mine.effort
    assert np.all(np.abs(force.mean(axis=0)) < 0.2 * noise)
    assert np.all(force.std(axis=0) < 1.5 * noise)


@pytest.mark.parametrize(("name", "seed"), [("lumped", 11), ("lumped", 12), ("tables", 11), ("tables", 12)])
def test_healthy_robots_stay_near_the_floor(name, seed):
    """The encoders of `tables` start anywhere within a count in each run, which is most of its transmission's floor."""
    make = PLANTS[name].make
    climate = Climate(21.8, 1.5, 150.0, 10**18)
    healthy = make(ROBOT, seed, (), climate)
    plans = [plan(label, s) for label in ("sweep", "loads") for s in (1, 2, 3)]
    runs = [healthy.run(p) for p in plans]
    floor = floors(runs, [stage_residuals(run, ROBOT) for run in runs], ROBOT)
    ideal = [
        [stage_residuals(p.run(r, ideal=True), ROBOT) for r in (plans[0], plans[3])]
        for p in (healthy, make(ROBOT, 0, (), climate, built=False))
    ]
    own = excess(*ideal)
    ratios = {k: np.sqrt(1 + own[k] / floor[k]) for k in own if floor.get(k) and not k.startswith("tip")}
    edge = 2.0 if name == "tables" else 1.3
    assert max(r for k, r in ratios.items() if not k.startswith("transmission")) < 1.3, ratios
    assert max(r for k, r in ratios.items() if k.startswith("transmission")) < edge, ratios
    assert 0.002 < floor["drive/delta_1"] < 0.008  # N^2, as in the recorded practice
    assert 1.0e-11 < floor["mechanism/tip"] < 1.6e-11
    assert floor["transport/delta_1"] == floor["controller/delta_1"] == 0.0


def test_same_seed_same_run_other_seed_other_noise():
    healthy = Plant(ROBOT, 5, (), CLIMATE)
    one, same, other = (healthy.run(plan("loads", s, duration=2.0)) for s in (1, 1, 2))
    effort = [run["drives/measured_js"].effort for run in (one, same, other)]
    np.testing.assert_array_equal(effort[0], effort[1])
    assert np.abs(effort[0] - effort[2]).max() > 0.1


def test_memory_elements():
    anchor = np.zeros(ELEMENTS)
    assert slip_state(1.0, anchor, 1e-3) == pytest.approx(1.0)
    drag_anchors(1.0, anchor, 1e-3)
    assert slip_state(1.0 - 1e-3, anchor, 1e-3) == pytest.approx(
        np.sum([0.4 * -1, 0.3 * (1 - 1 / 0.7), 0.2 * (1 - 1 / 1.3), 0.1 * (1 - 1 / 2.2)])
    )
    assert slip_state(1.0 - 2.1 * REACH[-1] * 1e-3, anchor, 1e-3) == pytest.approx(-1.0)
    follower = np.zeros(ELEMENTS)
    assert play_offset(1.0, 0.2, follower) == pytest.approx(-0.1)
    assert play_offset(0.95, 0.2, follower) == pytest.approx(-0.05)  # inside the gap nothing follows
    assert play_offset(-1.0, 0.2, follower) == pytest.approx(0.1)
