"""The tables plant: its curves, its kinematics, and that its laws have another shape than those of the lumped plant."""

from functools import cache

import numpy as np
import pytest
from sher3_challenge.cases.calibrate import residual_keys
from sher3_challenge.oracle import nominal as contract
from sher3_challenge.oracle.oracle import stage_residuals
from sher3_challenge.plants.kinds import Fault
from sher3_challenge.plants.plant import Climate, RunPlan
from sher3_challenge.plants.registry import truth_plant
from sher3_challenge.plants.tables.curves import RING, loop_slope, ring, teeth
from sher3_challenge.plants.tables.mechanism import ROOM, load_forces, tip_path
from sher3_challenge.plants.tables.plant import LAG, Transport, temperatures
from sher3_challenge.plants.tables.robot import nominal
from sher3_challenge.plants.tables.tip import follow, turned_over
from sher3_description import load_robot
from sher3_gap.excitation import excite

ROBOT = load_robot()


def test_kinematics_and_loads_are_those_of_the_contract():
    rng = np.random.default_rng(3)
    q = rng.uniform(-1, 1, (40, 5)) * [4e-3, 4e-3, 4e-3, 0.4, 8e-3]
    g = nominal(ROBOT).mechanism
    centres, tips, turns = tip_path(g, q, np.ones(40))
    theirs, rotation = contract.tip_pose(ROBOT, q)
    np.testing.assert_allclose(tips, theirs, atol=1e-12)
    np.testing.assert_allclose(turns, rotation.as_matrix(), atol=1e-11)
    np.testing.assert_allclose(centres, contract.platform_centre(ROBOT, q), atol=1e-12)
    force, gravity, external = np.array([0.3, -1.1, 0.7]), np.zeros(5), np.zeros(5)
    by_tip = contract.tip_jacobian(ROBOT, q).transpose(0, 2, 1) @ force
    for k in range(40):
        load_forces(g, q[k], force, gravity, external, np.zeros((ROOM, 3)))
        np.testing.assert_allclose(gravity, contract.gravity(ROBOT, q[k : k + 1])[0], atol=3e-7)
        np.testing.assert_allclose(external, by_tip[k], atol=1e-7)


def test_hysteresis_turns_to_one_over_e_in_its_reach_and_keeps_its_ends():
    slope = loop_slope(np.random.default_rng(2))
    x = np.concatenate([np.linspace(0, 5, 5000), np.linspace(5, 4, 2000)])
    z = turned_over(x, 1.0, slope)
    assert z[4999] == pytest.approx(1.0, abs=0.02)
    assert z[-1] == pytest.approx(-1 + 2 / np.e, abs=0.03)  # a Dahl state would be at 2 / e - 1 too
    assert np.all(np.abs(z) <= 1)


def test_play_is_taken_up_gradually_and_loses_its_width():
    flank = nominal(ROBOT).tip.flank
    x = np.concatenate([np.linspace(0, 50e-6, 300), np.linspace(50e-6, 0, 300)])
    y = follow(x, 10e-6, flank)
    assert x[299] - y[299] == pytest.approx(5e-6, rel=0.05) == y[-1] - x[-1]
    assert y[300 + 40] == y[299]  # inside the gap nothing follows


@pytest.mark.parametrize("order", [1, 4, 8])
def test_a_record_of_teeth_has_its_order_and_is_no_sine(order):
    wave = teeth(np.random.default_rng(1), order, 0.4, 0.3)
    sine = np.sin(order * 2 * np.pi * np.arange(RING) / RING + 0.4)
    assert 2 * np.mean(wave * sine) == pytest.approx(1.0, abs=1e-9)
    assert np.std(wave - sine) == pytest.approx(0.3 * np.std(sine), rel=1e-6)
    assert abs(np.diff(ring(np.random.default_rng(1)))).max() < 0.4  # smooth: no jump from node to node


def test_transport_is_exact_without_faults_late_by_its_rms_and_loses_its_share():
    rng = np.random.default_rng(4)
    np.testing.assert_array_equal(Transport().arrivals(100, 0.002, rng)[:, 0], np.arange(100) * 0.002)
    late = Transport(lateness=1e-4).arrivals(40_000, 0.002, rng)[:, 0] - np.arange(40_000) * 0.002
    assert np.sqrt(np.mean(late**2)) == pytest.approx(1e-4, rel=0.02)
    lost = np.isinf(Transport(loss=0.02).arrivals(40_000, 0.002, rng)[:, 0])
    assert lost.mean() == pytest.approx(0.02, rel=0.15)
    assert (lost[1:] & lost[:-1]).sum() > 3 * 40_000 * 0.02**2  # in bursts


def test_the_body_lags_behind_the_room():
    climate = Climate(22.0, 4.0, 120.0, 0)
    room, body = temperatures(climate, 0, np.linspace(0, 3000, 3001))
    slow = room[1:-1] - LAG * np.gradient(body, 1.0)[1:-1]
    np.testing.assert_allclose(body[1:-1], slow, atol=1e-3)  # tau d(body)/dt = room - body
    assert room[0] == body[0] == 22.0 and room[-1] == pytest.approx(26.0, abs=1e-6)


@cache
def shape(plant, name, seed):
    """What a fault adds to its stage's residual, (n,), over one run of the nominal robot."""
    truth, climate = truth_plant(plant), Climate(25.0, 0.0, 100.0, 10**18)
    kind = truth.kind(name)
    label = {"drive_lag": "steps", "force_scale": "loads"}.get(name, "reversals")
    plan = RunPlan(excite(label, ROBOT, posture="p1", duration=3.0), 0, 10**18, 1)
    fault = Fault(kind, kind.places[0], 2 * kind.start, seed)
    runs = [truth.make(ROBOT, 0, faults, climate, built=False).run(plan, ideal=True) for faults in ((fault,), ())]
    faulty, healthy = (stage_residuals(run, ROBOT) for run in runs)
    key = next(k for k in residual_keys(fault) if k in faulty)
    return (faulty[key] - healthy[key]).ravel()


@pytest.mark.parametrize(
    "name",
    ["drive_lag", "coulomb_friction", "stribeck_friction", "friction_drift", "presliding_friction", "cogging",
     "transmission_ripple", "transmission_hysteresis", "backlash", "encoder_eccentricity", "cable_drag_axis",
     "structural_vibration", "force_scale"],
)  # fmt: skip
def test_a_law_has_the_same_size_and_another_shape(name):
    """Of equal magnitude, the law of `tables` is like the lumped one, but one per cent or more is left when scaled."""
    lumped, tables = shape("lumped", name, 3), shape("tables", name, 3)
    size = np.sqrt(np.mean(tables**2) / np.mean(lumped**2))
    alike = (lumped @ tables) / np.sqrt((lumped @ lumped) * (tables @ tables))
    assert 0.6 < size < 1.6
    if name not in ("stribeck_friction", "cogging", "transmission_ripple"):  # their seeds draw other periods and speeds
        assert alike > 0.9
    assert 1 - alike**2 > 0.008
