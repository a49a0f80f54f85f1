"""Every effect: registered as the contract lists it, validated, composable, acting on its stage and on no other."""

import itertools

import numpy as np
import pytest
from sher3_common import FileError
from sher3_description import ACTUATORS, load_robot
from sher3_effects import load_effects, plants, save_effects
from sher3_effects.effects_file import effect_from_dict, effect_to_dict
from sher3_sim import EffectError, excitation, nominal_parameters, simulate, simulate_arrays, with_effects

ROBOT = load_robot()
PERIOD = ROBOT.control_period
CONTRACT = {
    "timing": "command_delay command_jitter dropped_commands drive_lag axis_skew",
    "scale": "controller_gain torque_constant lead_error encoder_scale force_scale",
    "limit": "force_saturation velocity_deadband",
    "friction": "coulomb_friction stribeck_friction viscous_friction presliding_friction position_friction"
    " friction_drift",
    "inertia": "payload_mass gravity_load",
    "periodic": "cogging transmission_ripple encoder_eccentricity",
    "lost_motion": "backlash transmission_hysteresis joint_clearance",
    "compliance": "transmission_compliance structural_compliance link_compliance tool_bending structural_vibration",
    "geometry": "link_length_error platform_geometry_error rail_tilt base_tilt tilt_linkage_error tool_offset"
    " encoder_offset",
    "drift": "thermal_expansion force_drift",
    "wrench": "force_bias tool_gravity force_crosstalk cable_drag",
}
SEES = {
    "transport": {"transport"},
    "controller": {"controller"},
    "drive": {"drive"},
    "motor_mechanics": {"mechanics"},
    "transmission": {"transmission"},
    "mechanism": {"tip"},
    "structure": {"tip"},
}
"""Conditional checks, see `stage_gaps`, that an effect of a stage must trip."""
SENSING = {"encoder_scale": {"transmission", "tip"}, "encoder_eccentricity": {"transmission", "tip"}}


def drive(n=700):
    t = np.arange(n) * PERIOD
    wave = 1.5e-3 * np.sin(2 * np.pi * 1.5 * t) + 4e-5 * np.sign(np.sin(2 * np.pi * 4 * t))
    goal = np.outer(wave, [1.0, -0.8, 0.6, 40.0, 0.9])
    wrench = np.zeros((n, 6))
    wrench[200:400, :3], wrench[500:, 2] = (0.6, -0.5, 0.4), -0.8
    return excitation(goal, None, wrench, 27.0, period=PERIOD)


DRIVE = drive()


def cases():
    for kind in plants().values():
        for actuator in (place for place in kind.sites if place not in ("delta_2", "delta_3")):
            yield pytest.param(kind(actuator), id=f"{kind.id}-{actuator}")


def stage_gaps(effect):
    """Which stages break their nominal law, each given its own measured input."""
    p = with_effects(ROBOT, [effect]).without_noise()
    command, out = simulate_arrays(p, DRIVE)
    quiet = nominal_parameters(ROBOT).without_noise()
    broken = set()

    def check(stage, gap, scale):
        if np.abs(np.asarray(gap) / scale).max() > 1e-3:
            broken.add(stage)

    motor_scale = np.array([1e-6] * 3 + [3e-5, 1e-6])
    check("transport", out["demand"][1:] - command[:-1], motor_scale * 1e3)
    limits = np.array([a.limits.velocity for a in ROBOT.actuators])
    law = np.clip(DRIVE.velocity + ROBOT.position_gain * (DRIVE.position - out["load"]), -limits, limits)
    check("controller", law - command, motor_scale * 1e3)
    zeros = p.axis["encoder_offset"]
    check("transmission", out["load"] - out["motor"], motor_scale)
    check("force", out["wrench"] - contact_reading(quiet, out), [1e-2] * 3 + [1e-4] * 3)
    check("tip", out["tip_position"] - tips(out["load"]), 1e-6)
    if np.any(zeros != 0):
        broken.discard("force")
    nominal = replayed(quiet, out)
    motion = np.abs((out["motor"] - zeros - nominal["motor"]) / motor_scale).max()
    effort = np.abs((out["effort"] - nominal["effort"]) / ([0.1] * 3 + [0.0025, 0.1])).max()
    if motion > 0.05 or effort > 0.05:
        broken.add("drive")
        broken.add("mechanics")
    return broken


def replayed(p, out):
    """The nominal drives and motors under the demands that were executed."""
    demand = np.vstack([out["demand"][1:], out["demand"][-1:]])
    start = np.tile(out["motor"][0], (len(out), 1))
    inner = excitation(start, None, DRIVE.wrench, 27.0, command=demand, period=PERIOD)
    return simulate_arrays(p, inner)[1]


def contact_reading(p, out):
    inner = excitation(out["load"], np.zeros_like(out["load"]), DRIVE.wrench, 27.0, period=PERIOD)
    rows = [simulate_arrays(p, _at(inner, k))[1]["wrench"][0] for k in range(0, len(out), 175)]
    full = out["wrench"].copy()
    full[::175] = rows
    return full


def _at(inner, k):
    return excitation(inner.position[[k, k]], None, inner.wrench[[k, k]], 27.0, period=PERIOD)


def tips(q):
    from sher3_kinematics.kernel import kernel_parameters
    from sher3_sim.closed_loop import poses

    return poses(kernel_parameters(ROBOT), np.ascontiguousarray(q))[0]


def test_registry_is_the_contracts_list():
    listed = {name: family for family, names in CONTRACT.items() for name in names.split()}
    assert {kind.id: kind.family for kind in plants().values()} == listed
    for kind in plants().values():
        assert kind.__module__ == f"sher3_effects.{kind.family}.{kind.id}"
        assert kind.__doc__ and kind.specification(kind.sites[0])


def test_nominal_plant_breaks_no_stage():
    assert stage_gaps(plants()["command_delay"]("all", delay=0.0)) == set()


@pytest.mark.parametrize("effect", list(cases()))
def test_effect_shows_in_its_stage(effect):
    broken = stage_gaps(effect)
    if effect.stage == "sensing" or effect.actuator == "force_sensor":
        assert broken >= SENSING.get(effect.id, {"force"})
    else:
        assert broken >= SEES[effect.stage]
    if effect.stage in ("mechanism", "structure") or effect.actuator == "force_sensor":
        assert not broken & {"transport", "controller", "transmission"}
    if effect.stage == "transport":
        assert not broken & {"controller", "transmission", "tip", "force"}
    if effect.stage in ("drive", "motor_mechanics") and effect.actuator != "force_sensor":
        assert not broken & {"transport", "controller", "transmission", "tip", "force"}


@pytest.mark.parametrize("kind", plants().values(), ids=lambda kind: kind.id)
def test_bounds_units_and_defaults(kind):
    for actuator in kind.sites:
        for name, spec in kind.specification(actuator).items():
            assert spec.low <= spec.default <= spec.high
            for value in (spec.low, spec.high):
                assert getattr(kind(actuator, **{name: value}), name) == value
            for bad in (
                np.nextafter(spec.high, np.inf) * (1 + 1e-9) + 1e-12,
                float("nan"),
                float("inf"),
                "1",
                None,
                True,
            ):
                with pytest.raises(EffectError, match=name):
                    kind(actuator, **{name: bad})
    with pytest.raises(EffectError, match="actuator"):
        kind("elbow")


def test_roll_has_rotary_units():
    on_roll, on_slider = (plants()["backlash"].specification(a)["width"] for a in ("roll", "delta_1"))
    assert (on_roll.unit, on_slider.unit) == ("rad", "m") and on_roll.default > on_slider.default


def test_effects_file_round_trip(tmp_path):
    every = [kind(actuator) for kind in plants().values() for actuator in kind.sites]
    save_effects(tmp_path / "effects.yaml", every)
    assert load_effects(tmp_path / "effects.yaml") == every
    assert effect_from_dict(effect_to_dict(every[0])) == every[0]


@pytest.mark.parametrize(
    ("text", "error", "names"),
    [
        ("schema: sher3.effects/2\neffects: []", FileError, "schema"),
        ("schema: sher3.effects/1\neffects: {}", FileError, "list"),
        ("[", FileError, "not valid YAML"),
        ("schema: sher3.effects/1\neffects: [{effect: gremlins, actuator: roll}]", EffectError, "gremlins"),
        ("schema: sher3.effects/1\neffects: [{effect: backlash, actuator: elbow}]", EffectError, "elbow"),
        ("schema: sher3.effects/1\neffects: [{effect: backlash}]", EffectError, "actuator"),
        ("schema: sher3.effects/1\neffects: [{effect: backlash, actuator: roll, parameters: {b: 1}}]", EffectError,
         "no such"),
        ("schema: sher3.effects/1\neffects: [{effect: backlash, actuator: roll, parameters: {width: 3}}]", EffectError,
         "bounds"),
    ],
)  # fmt: skip
def test_wrong_effects_files_are_refused(tmp_path, text, error, names):
    path = tmp_path / "effects.yaml"
    path.write_text(text)
    with pytest.raises(error, match=names):
        load_effects(path)


def test_missing_effects_file(tmp_path):
    with pytest.raises(FileError, match="absent"):
        load_effects(tmp_path / "absent.yaml")


def test_same_effect_twice_on_one_axis_is_refused():
    with pytest.raises(EffectError, match="twice"):
        with_effects(ROBOT, [plants()["backlash"]("roll"), plants()["backlash"]("roll", width=1e-5)])


def test_effects_compose_in_any_order():
    names = ("coulomb_friction", "backlash", "command_delay", "torque_constant", "link_length_error", "payload_mass")
    effects = [plants()[name](plants()[name].sites[0]) for name in names]
    results = []
    for order in itertools.islice(itertools.permutations(effects), 0, 720, 240):
        results.append(simulate_arrays(with_effects(ROBOT, order), DRIVE, 3)[1])
    assert all(np.array_equal(results[0][c], r[c]) for r in results for c in ("motor", "load", "effort", "wrench"))


def test_all_effects_together_stay_finite():
    every = [kind(kind.sites[-1]) for kind in plants().values()]
    run = simulate(ROBOT, DRIVE.position, DRIVE.wrench, every, temperature=25.0)
    for topic in run.streams:
        for column in run[topic].columns.values():
            assert np.isfinite(np.asarray(column, dtype=float)).all()


@pytest.mark.parametrize("kind", plants().values(), ids=lambda kind: kind.id)
def test_integration_has_converged(kind):
    """Default step against one sixteen times finer: far below rounding and effort noise."""
    places = [a for a in kind.sites if a in ("delta_1", "roll", "tilt")] or [kind.sites[0]]
    p = with_effects(ROBOT, [kind(place) for place in places]).without_noise()
    _, coarse = simulate_arrays(p, DRIVE)
    p.substeps *= 16
    _, fine = simulate_arrays(p, DRIVE)
    counts = np.array([a.motor_encoder for a in ROBOT.actuators])
    noise = np.array([0.002 * a.drive.rated for a in ROBOT.actuators])
    tolerance = 0.05
    assert np.sqrt(np.mean(((coarse["motor"] - fine["motor"]) / counts) ** 2, axis=0)).max() < tolerance
    assert np.sqrt(np.mean(((coarse["effort"] - fine["effort"]) / noise) ** 2, axis=0)).max() < tolerance


def test_actuator_order():
    assert [plants()["backlash"](name).rows for name in ACTUATORS] == [[0], [1], [2], [3], [4]]
    assert plants()["command_delay"]("all").rows == [0, 1, 2, 3, 4]
