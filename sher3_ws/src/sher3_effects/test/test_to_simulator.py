"""What a cause's parameters mean to the simulator: every converter against the simulator's own effects."""

import math

import pytest
from sher3_description import load_robot
from sher3_diagnosis.verdict import Cause, Interval, Parameter
from sher3_effects import library, to_effects

ROBOT = load_robot()


def cause(effect, actuator, **values):
    entry = library()[effect]
    return Cause(
        effect=effect,
        family=entry.family,
        stage=entry.stage,
        actuator=actuator,
        parameters={n: Parameter(value=v, unit="1") for n, v in values.items()},
        closure=Interval(value=0.9),
    )


@pytest.mark.parametrize(
    ("effect", "actuator", "values", "expected"),
    [
        ("coulomb_friction", "tilt", {"force": 1.0, "displacement": 2e-6}, {"force": 1.0, "displacement": 2e-6}),
        ("gravity_load", "delta_1", {"relative": 0.2}, {"mass": 0.2 * ROBOT.delta.moving_mass}),
        ("force_crosstalk", "force_sensor", {"coefficient": 0.04, "source": 2.0, "target": 0.0}, {"xz": 0.04}),
        ("rail_tilt", "delta_2", {"angle": 1e-3, "x": 0.0, "y": 1e-3}, {"angle": 1e-3, "azimuth": math.radians(-30)}),
        ("platform_geometry_error", "delta_2", {"x": -1e-5, "y": 0.0}, {"x": 5e-6, "y": 1e-5 * math.sqrt(0.75)}),
        ("tilt_linkage_error", "tilt", {"length": 3e-5, "member": 0.0}, {"crank": 3e-5, "length": 0.0}),
        (
            "position_friction",
            "roll",
            {"force": 0.1, "amplitude": 0.04, "wavelength": 0.0314},
            {"periods_per_rev": 2.0},
        ),
        ("cable_drag", "roll", {"preload": 0.3, "stiffness": 0.02, "force": 0.004}, {"force": 0.004}),
    ],
)
def test_parameters_are_translated(effect, actuator, values, expected):
    (made,) = to_effects([cause(effect, actuator, **values)], ROBOT)
    assert made.id == effect
    for name, value in expected.items():
        assert getattr(made, name) == pytest.approx(value, rel=2e-3, abs=1e-12)


def test_friction_that_runs_in_is_a_level_and_a_decay():
    values = {"force": 1.5, "drift": -0.6, "time_constant": 3.0}
    parts = library()["friction_drift"].to_simulator("tilt", values, ROBOT)
    assert parts[0] == ("friction_drift", "tilt", {"force": 0.6, "time_constant": 3.0})
    assert parts[1][0] == "coulomb_friction" and parts[1][2]["force"] == pytest.approx(0.9)


def test_a_larger_platform_moves_every_leg():
    made = to_effects([cause("platform_geometry_error", "tip", radius=2e-5)], ROBOT)
    assert [(e.actuator, e.x) for e in made] == [("delta_1", 2e-5), ("delta_2", 2e-5), ("delta_3", 2e-5)]


def test_values_beyond_the_plants_bounds_are_clipped():
    (made,) = to_effects([cause("backlash", "tilt", width=1.0)], ROBOT)
    assert made.width == type(made).specification("tilt")["width"].high
