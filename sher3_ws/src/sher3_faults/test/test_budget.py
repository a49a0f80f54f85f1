"""The travel budget: its arithmetic by hand, its bound against a simulated brake, and what it refuses."""

import json

import numpy as np
import pytest
from sher3_control.motion.speed_cap import Regime
from sher3_control.settings import ControlSettings
from sher3_description import load_robot
from sher3_drivers.settings import default_settings
from sher3_faults.braking import Braking
from sher3_faults.budget import CUT_OFF, GUARDED, BudgetExceeded, TravelBudget
from sher3_faults.creep import ECHOES

ROBOT = load_robot()


def budget(period=0.002, control=None, **drives):
    robot = ROBOT.model_copy(update={"control_period": period})
    settings = default_settings(period).model_copy(update=drives)
    return TravelBudget(robot, ControlSettings.from_robot(robot, control), settings)


def row_of(found, regime, fault):
    return next(row for row in found.of(regime) if row.fault == fault)


@pytest.mark.parametrize("period", [0.001, 0.002])
def test_the_defaults_keep_both_budgets(period):
    found = budget(period)
    found.require()
    assert {row.regime for row in found.rows} == {"near_tissue", "free", "bench"}
    assert all(0.0 < row.travel <= row.budget for regime in GUARDED for row in found.of(regime))


def test_travel_is_time_times_speed():
    row = row_of(budget(), Regime.FREE, "pedal silent or dead")
    assert row.detection == pytest.approx(0.020 + 2 * 0.002)
    assert row.travel == pytest.approx(row.speed * (row.detection + row.stop) + row.parting)
    assert row.stop == pytest.approx(max(a.mass / a.drive.kp for a in ROBOT.actuators), rel=0.1)


@pytest.mark.parametrize(
    ("change", "fault", "named"),
    [
        ({"host_heartbeat_limit": 0.05}, "motor driver or computer dead", "drives.host_heartbeat_limit"),
        ({"supervisor_limit": 0.05}, "supervisor dead", "drives.supervisor_limit"),
        ({"encoder_distance": 2e-5}, "encoder wrong, coupling slips", "encoder_distance"),
    ],
)
def test_a_longer_time_is_refused_by_name(change, fault, named):
    with pytest.raises(BudgetExceeded, match=named) as caught:
        budget(**change).require()
    error = caught.value
    assert error.row.fault == fault and error.row.travel > error.row.budget
    data = json.dumps(error.to_dict(), default=str)
    assert "um" in data and "lower" in error.remedy


def test_the_remedy_is_one():
    """Settings at the speed that the error names keep the budget."""
    with pytest.raises(BudgetExceeded) as caught:
        budget(host_heartbeat_limit=0.05).require()
    speed = float(caught.value.remedy.rsplit(" to ", 1)[1].split()[0])
    share = speed / 0.005
    assert caught.value.row.regime == "near_tissue" or share < 1.0
    name = "near" if caught.value.row.regime == "near_tissue" else "free"
    usual = {"near": (0.0005, 0.03), "free": (0.005, 0.3)}[name]
    motion = {f"{name}_speed": speed, f"{name}_turning": usual[1] * speed / usual[0]}
    found = budget(control={"motion": motion}, host_heartbeat_limit=0.05)
    row = row_of(found, Regime(caught.value.row.regime), caught.value.row.fault)
    assert row.travel <= 1.001 * row.budget


def test_a_slow_rate_is_refused_and_a_lower_cap_lets_it_pass():
    with pytest.raises(BudgetExceeded):
        budget(0.005).require()
    slower = {"near_speed": 0.0004, "near_turning": 0.024, "free_speed": 0.004, "free_turning": 0.24}
    budget(0.005, {"motion": slower}).require()


def test_the_ramp_bound_holds_for_a_simulated_brake():
    """Axes with the nominal drive's lag on their ramps, integrated finely, from random full-speed tip velocities."""
    braking, rng = Braking(ROBOT), np.random.default_rng(5)
    _, bound = braking.distances(0.005, 0.3)
    jacobians = braking.jacobians[rng.integers(len(braking.jacobians), size=100)]
    twists = rng.standard_normal((100, 6))
    twists[:, :3] *= 0.005 / np.linalg.norm(twists[:, :3], axis=1, keepdims=True)
    twists[:, 3:] *= 0.3 / np.linalg.norm(twists[:, 3:], axis=1, keepdims=True)
    demand = np.einsum("nij,nj->ni", np.linalg.pinv(jacobians), twists)
    demand /= np.maximum(1.0, np.abs(demand / braking.velocity).max(axis=1, keepdims=True))
    velocity, way, dt, worst = demand.copy(), np.zeros_like(demand), 2e-5, 0.0
    for _ in range(3000):
        demand = demand - np.sign(demand) * np.minimum(np.abs(demand), braking.deceleration * dt)
        velocity = velocity + dt * (demand - velocity) / braking.lag
        way = way + dt * velocity
        tip = np.einsum("nij,nj->ni", jacobians[:, :3], way)
        worst = max(worst, float(np.linalg.norm(tip, axis=1).max()))
    assert 0.5 * bound < worst <= bound


def test_a_disobedient_drive_is_stated():
    found = budget().to_dict()
    near, free, bench = (found["runaway"][regime] for regime in ("near_tissue", "free", "bench"))
    assert set(near) == {a.name for a in ROBOT.actuators}
    assert max(near.values()) <= 40e-6 and max(free.values()) <= 250e-6 < max(bench.values())
    assert "no travel guarantee" in budget().as_text()


def test_every_axis_at_every_speed_and_with_every_echo_is_stated():
    """From 1 um/s to the drive's own limit the tip travels at most 40 um near tissue and 250 um free."""
    found = budget()
    for regime, most in ((Regime.NEAR_TISSUE, 40e-6), (Regime.FREE, 250e-6)):
        creeps = found.creeps[regime.value]
        assert {(c.axis, c.echo) for c in creeps} == {(a.name, e) for a in ROBOT.actuators for e in ECHOES}
        assert min(c.speed for c in creeps) == 1e-6 and max(c.travel for c in creeps) <= most
        assert all(c.speed >= 0.0 and np.isfinite(c.travel) for c in creeps)
        assert {c.axis: c.travel for c in creeps if c.echo == "false"} == found.runaway[regime.value]


def test_an_axis_that_goes_by_itself_and_is_cut_off_by_hand():
    """The tilt near tissue: 0.9 mm/s for 27 ms, two periods and its lag, and its brake; all axes are as stated."""
    found, braking = budget().cut_off, Braking(ROBOT)
    way = 9e-4 * (31e-3 + braking.lag[4]) + 8.1e-7 / (2.0 * braking.deceleration[4])
    assert found["near_tissue"]["tilt"] == pytest.approx(braking.reach()[4] * way, rel=1e-6)
    assert all(max(found[regime.value].values()) <= most for regime, most in CUT_OFF.items())


def test_a_creep_by_hand():
    """A leg at 1 mm/s near tissue: 7 um, 3 ms of the 1.6 mm/s it may need there, 4 ms of lag and 4 ms of periods."""
    found = budget()
    reach = Braking(ROBOT).reach()[0]
    leg = {c.echo: c.travel for c in found.creeps["near_tissue"] if (c.axis, c.speed) == ("delta_1", 1e-3)}
    speeds = Braking(ROBOT).axis_speeds(5e-4, 0.03)
    way = 7e-6 + 3e-3 * min(speeds[0], 2e-3) + 1e-3 * (4e-3 + 10.5 / 2640.0) + 1e-6 / (2 * 1.83)
    assert leg["false"] == leg["missing"] == pytest.approx(reach * way, rel=1e-3)
    assert leg["honest"] < 0.5 * leg["false"]


def test_a_false_force_is_stated():
    """1 N is found in time for the budget of 25 um, and 0.2 N along its way, which 0.1 mm/s make 50 um."""
    near = {f.force: f for f in budget().false_forces(Regime.NEAR_TISSUE)}
    assert near[1.0].travel <= 25e-6 and near[0.6].travel <= 50e-6
    assert 40e-6 <= near[0.2].travel <= 60e-6 and near[0.2].detection < 0.6
    assert all(f.travel <= 250e-6 for f in budget().false_forces(Regime.FREE) if f.force >= 0.3)
    assert budget().false_forces(Regime.BENCH) == []
    json.dumps(budget().to_dict(), allow_nan=False)
