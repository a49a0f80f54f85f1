"""Every fault of the MuJoCo plant shows in its own stage, and upstream stages stay clean; fast tests take a sample."""

from functools import cache

import numpy as np
import pytest
from sher3_challenge.cases.calibrate import residual_keys
from sher3_challenge.oracle.oracle import excess, stage_residuals
from sher3_challenge.plants.grammar import CATALOGUE
from sher3_challenge.plants.kinds import Fault
from sher3_challenge.plants.plant import Climate, RunPlan
from sher3_challenge.plants.registry import truth_plant
from sher3_description import ACTUATORS, load_robot
from sher3_gap.excitation import excite

ROBOT = load_robot()
WARM = Climate(25.0, 0.0, 100.0, 10**18)
MUJOCO = truth_plant("mujoco")
KINDS = {**MUJOCO.library, **MUJOCO.outside}
PLACES = [(name, place) for name, kind in KINDS.items() for place in dict.fromkeys((kind.places[0], kind.places[-1]))]
SAMPLE = PLACES[::6]
# mean-square floors of a slider, as measured on healthy robots; on roll by the squares of the units
FLOOR = {"drive": 5e-3, "motor_mechanics": 4.5e-3, "transmission": 9e-14, "mechanism": 1.4e-11, "structure": 1.3e-11,
         "sensing": 3e-5, "transport": 1e-10, "controller": 1e-10}  # fmt: skip
ROLL = {"drive": 6.25e-4, "motor_mechanics": 6.25e-4, "transmission": 986, "transport": 9604, "controller": 9604}
LOADED = {"structural_compliance", "link_compliance", "tool_bending", "transmission_compliance", "tool_clamp_slip",
          "rubber_coupling"}  # fmt: skip
FAST = {"structural_vibration", "loose_read_head", "loose_counterweight", "hot_motor"}
FAINT = {("tilt_linkage_error", "tilt"), ("torque_constant", "tilt"), ("payload_mass", "tilt"), ("hot_motor", "tilt")}
"""Kinds that barely show at the magnitude at which calibration starts; its bounds reach further."""


@cache
def plan(label):
    return RunPlan(excite(label, ROBOT, posture="p1", duration=2.4, set_point_jumps=True), 0, 10**18, 1)


@cache
def healthy(label):
    return stage_residuals(MUJOCO.make(ROBOT, 0, (), WARM, built=False).run(plan(label), ideal=True), ROBOT)


def floor(key):
    stage, actuator = key.split("/")
    return FLOOR[stage] * (ROLL.get(stage, 1.0) if actuator == "roll" else 1.0)


def label_for(kind):
    if kind.name in CATALOGUE:  # laws that follow the motion
        return "sweep"
    if kind.name in LOADED or kind.places == ("force_sensor",):
        return "loads"
    return "steps" if kind.stage == "drive" or kind.name in FAST else "sweep"


def ratios(name, place):
    """Return the fault, its plant, and the fault's own part over the floor by residual."""
    kind = KINDS[name]
    label = label_for(kind)
    region = tuple(plan(label).excitation.position.mean(axis=0))
    times = 2 + 2 * (name in CATALOGUE)  # what an axis without load feels of its own force is faint
    fault = Fault(kind, place, min(kind.most, times * kind.start), 3)
    plant = MUJOCO.make(ROBOT, 0, (fault,), WARM, built=False, region=region)
    own = excess([stage_residuals(plant.run(plan(label), ideal=True), ROBOT)], [healthy(label)])
    return fault, plant, {k: np.sqrt(value / floor(k)) for k, value in own.items() if not k.startswith("tip")}


def check(name, place):
    fault, plant, ratio = ratios(name, place)
    kind = fault.kind
    shown = max(ratio[key] for key in residual_keys(fault) if key in ratio)
    assert shown > (0.05 if (name, place) in FAINT or name in CATALOGUE else 0.3), ratio
    for stage in ("transport", "controller"):
        if kind.stage != stage:
            assert max(value for key, value in ratio.items() if key.startswith(stage)) == 0.0
    if kind.stage not in ("transport", "controller", "drive"):
        assert max(ratio[f"drive/{a}"] for a in ACTUATORS) < max(0.1, 0.05 * shown)
    if kind.stage in ("mechanism", "structure") and name not in ("encoder_offset", "joint_clearance"):
        assert max(value for key, value in ratio.items() if key.startswith(("motor", "trans"))) < 0.1
    if kind.places == ("force_sensor",):
        assert max(value for key, value in ratio.items() if not key.startswith("sensing")) == 0.0
    assert all(np.isfinite(value) for value in plant.parameters()[0].values())


@pytest.mark.parametrize(("name", "place"), SAMPLE)
def test_a_sampled_fault_shows_in_its_stage_and_not_upstream(name, place):
    check(name, place)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "place"), PLACES)
def test_a_fault_shows_in_its_stage_and_not_upstream(name, place):
    check(name, place)


def test_gaps_and_bristles_have_the_size_they_are_said_to_have():
    """What the load encoder loses at a reversal is the width of the gap, and that of gradual lost motion."""
    for name, magnitude, width in (("backlash", 20e-6, 20e-6), ("transmission_hysteresis", 10e-6, 20e-6)):
        fault = Fault(MUJOCO.kind(name), "delta_2", magnitude, 3)
        run = MUJOCO.make(ROBOT, 0, (fault,), WARM, built=False).run(plan("sweep"), ideal=True)
        lost = run["measured_js"].position[:, 1] - run["drives/measured_js"].position[:, 1]
        assert np.quantile(lost, 0.98) - np.quantile(lost, 0.02) == pytest.approx(width, rel=0.05), name


def test_friction_and_payload_are_felt_as_they_are_said_to_be():
    """At constant speed the drive carries friction; a payload's weight shows on the vertical rails."""
    for name, magnitude, parameter in (("coulomb_friction", 2.0, "force"), ("presliding_friction", 2.0, "force")):
        fault = Fault(MUJOCO.kind(name), "delta_1", magnitude, 3)
        plant = MUJOCO.make(ROBOT, 0, (fault,), WARM, built=False)
        clean, faulty = (
            p.run(plan("sweep"), ideal=True)["drives/measured_js"].effort[:, 0]
            for p in (MUJOCO.make(ROBOT, 0, (), WARM, built=False), plant)
        )
        extra = np.quantile(np.abs(faulty - clean), 0.6)
        assert extra == pytest.approx(plant.parameters()[0][parameter], rel=0.03), name


def test_an_outside_catalogue_of_its_own():
    own = set(MUJOCO.outside) - set(CATALOGUE)  # the grammar belongs to no plant
    assert len(own) >= 12
    assert not own & set(truth_plant("lumped").outside)


def test_what_a_bristle_holds_does_not_slip_back():
    """Gradual lost motion all but stays while the robot stands still: it creeps back over ten seconds."""
    fault = Fault(MUJOCO.kind("transmission_hysteresis"), "tilt", 10e-6, 3)
    e = excite("sweep", ROBOT, posture="p1")
    assert not e.velocity[-300:, 4].any()
    run = MUJOCO.make(ROBOT, 0, (fault,), WARM, built=False).run(RunPlan(e, 0, 10**18, 1), ideal=True)
    lost = (run["measured_js"].position - run["drives/measured_js"].position)[-250:, 4]
    assert np.abs(lost).min() > 3e-6 and np.ptp(lost) < 5e-7


def test_faults_on_one_axis_do_not_undo_each_other():
    """A drive that is late and clamped; a force of the motor's poles before a spring that carries the load."""
    late, clamped = (Fault(MUJOCO.kind(name), "tilt", 1e-3, 3) for name in ("drive_lag", "force_saturation"))
    drive = MUJOCO.make(ROBOT, 0, (late, clamped), WARM, built=False).faulty().axes[4].drive
    assert drive.lag == 1e-3 and drive.limit == pytest.approx(12.0, rel=2e-3)
    poles, spring = (
        Fault(MUJOCO.kind("cogging"), "delta_1", 0.3, 3),
        Fault(MUJOCO.kind("transmission_compliance"), "delta_1", 1e-6, 3),
    )
    run = MUJOCO.make(ROBOT, 0, (poles, spring), WARM, built=False).run(plan("sweep"), ideal=True)
    plain = MUJOCO.make(ROBOT, 0, (), WARM, built=False).run(plan("sweep"), ideal=True)
    extra = (run["drives/measured_js"].effort - plain["drives/measured_js"].effort)[:, 0]
    assert 0.2 < np.abs(extra).max() < 0.5


def test_a_wedge_rubs_alike_at_all_speeds_and_harder_one_way():
    """Dry friction of a contact, not a viscous one, and in radians: against the wedge it is several times harder."""
    e = excite("sweep", ROBOT, posture="p1")
    v, q = e.velocity[:, 0], e.position[:, 0] - e.position[:, 0].mean()
    fault = Fault(MUJOCO.kind("wedge_contact"), "delta_1", 1.0, 3)
    region = tuple(e.position.mean(axis=0))
    runs = (MUJOCO.make(ROBOT, 0, faults, WARM, built=False, region=region) for faults in ((fault,), ()))
    wedged, plain = (r.run(RunPlan(e, 0, 10**18, 1), ideal=True)["drives/measured_js"].effort[:, 0] for r in runs)

    def rub(speed):
        there = (np.abs(v - speed) < 0.05 * abs(speed)) & (np.abs(q + 0.4e-3) < 0.2e-3)
        return float(np.median((wedged - plain)[there]))

    slow, fast = 1.1e-3, 4.15e-3  # m/s, speeds of the sweep in both directions
    assert rub(fast) == pytest.approx(rub(slow), rel=0.15) and rub(slow) > 0.1
    assert rub(-slow) == pytest.approx(rub(-fast), rel=0.15) and -rub(-slow) > 3 * rub(slow)
