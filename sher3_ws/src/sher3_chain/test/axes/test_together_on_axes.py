"""Several ordinary causes at once: each has its own number, none takes a part of another's."""

import pytest
from drawn_axes import drawn_axis, drawn_servo
from sher3_diagnosis import diagnose


def told(drawn):
    """Return the causes by id, and what is named in place of what is true: the same force by another law."""
    return {c.effect: c for c in diagnose(drawn.machine, [drawn.run]).verdict.causes}


def test_a_spring_a_payload_and_three_frictions_at_once():
    """A search by steps left all of it outside the library: no law alone explains a third of the gap."""
    drawn = drawn_axis(4)
    assert len(drawn.truth) == 5
    found = told(drawn)
    mass = {"payload_mass", "torque_constant"}  # without a known weight the two are one number
    assert set(found) - mass == {"stribeck_friction", "spring_torque", "viscous_friction"}
    (named,) = set(found) & mass
    assert set(found[named].rivals) >= mass - {named}
    for effect, name in (("viscous_friction", "extra"), ("spring_torque", "stiffness")):
        parameter = found[effect].parameters[name]
        assert parameter.low <= drawn.truth[effect][name] <= parameter.high


def test_a_servo_with_a_weight_at_an_arm_keeps_lag_stiction_and_weight_apart():
    """The weight went into the stiction, twice as large as it is."""
    drawn = drawn_servo(5)
    found = told(drawn)
    assert set(found) == {"drive_lag", "coulomb_friction", "gravity_load"}
    assert found["coulomb_friction"].parameters["force"].value == pytest.approx(0.088, rel=0.05)
    arm = found["gravity_load"].parameters["arm"]
    assert arm.low <= drawn.truth["gravity_load"]["arm"] <= arm.high


def test_a_late_effort_beside_friction_and_a_weight_is_told():
    """Stops of milliseconds once passed for motion, and all of it was outside the library."""
    drawn = drawn_axis(3022)
    found = told(drawn)
    assert set(found) == set(drawn.truth)
    delay = drawn.truth["sensor_delay"]["delay"]
    assert found["sensor_delay"].parameters["effort_delay"].value == pytest.approx(delay, rel=0.05)


def test_a_dead_time_beside_lag_and_stiction_of_a_servo():
    found = told(drawn_servo(3008))
    assert set(found) == {"drive_lag", "coulomb_friction", "gravity_load"}
    assert found["drive_lag"].parameters["delay"].low > 0.0


@pytest.mark.parametrize("seed", [3002, pytest.param(3015, marks=pytest.mark.slow)])
def test_friction_that_falls_with_speed_beside_a_spring_a_payload_and_viscosity(seed):
    """A late effort of -2 ms once took the place of the rise at low speed; of the other machine the payload went."""
    drawn = drawn_axis(seed)
    assert {"stribeck_friction", "spring_torque", "payload_mass"} < set(drawn.truth)
    found = told(drawn)
    assert set(found) == {"stribeck_friction", "spring_torque", "viscous_friction", "torque_constant"}
    # How often the interval holds the truth is counted over many machines (`bench/drawn_machines.py`), not on one.
    sliding = found["stribeck_friction"].parameters["force"].value
    assert sliding == pytest.approx(drawn.truth["stribeck_friction"]["force"], rel=0.03)


@pytest.mark.parametrize("seed", [3003, pytest.param(3019, marks=pytest.mark.slow)])
def test_a_late_effort_beside_friction_that_falls_with_speed(seed):
    """Without the rise of friction at low speed the effort looked early; a filter of 50 Hz is as late as the other."""
    drawn = drawn_axis(seed)
    found = told(drawn)
    assert {"stribeck_friction", "sensor_delay", "viscous_friction"} < set(found)
    delay = drawn.truth["sensor_delay"]["delay"]
    assert found["sensor_delay"].parameters["effort_delay"].value == pytest.approx(delay, rel=0.05)


def test_viscous_friction_that_a_plain_dry_one_hides_is_beside_the_one_that_falls_with_speed():
    """Neither is possible without the other; both went, and another motion was foretold seven times worse."""
    assert set(told(drawn_axis(7504))) == {"stribeck_friction", "viscous_friction", "gravity_load", "sensor_delay"}


@pytest.mark.parametrize(
    "seed",
    [
        21002,  # 1.5 periods of 1 ms, less than a tenth of a period of the filter's cut-off
        21029,  # without it what is left is below a floor that is too large
        21042,  # a search for play behind the encoder left more than the plain laws, both below the floor
        21046,  # a wrong delay made all laws possible beside it; gain, mass and weight say the same
    ],
)
def test_a_late_effort_beside_ordinary_causes(seed):
    drawn = drawn_axis(seed)
    found = told(drawn)
    assert set(found) == set(drawn.truth)
    late = found["sensor_delay"].parameters["effort_delay"]
    assert late.low <= drawn.truth["sensor_delay"]["delay"] <= late.high
