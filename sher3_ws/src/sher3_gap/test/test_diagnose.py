"""Truth in, truth out: the simulator with a known effect, diagnosed.

A unit test of the chain, not evidence of its power.
"""

import pytest
from sher3_effects import plants
from sher3_gap.sher import diagnose_runs
from simulated import ROBOT, runs_of, signals

LABELS = ("reversals", "sweep")


def case_with(*effects, labels=LABELS):
    """Two excitations with repeats and three single runs."""
    return signals([*runs_of(labels, effects), *runs_of(("loads", "postures", "task"), effects, repeats=1)])


def verdict_of(*effects, without=(), **options):
    return diagnose_runs(case_with(*effects, **options), ROBOT, without).verdict


def test_a_healthy_robot_has_no_gap():
    verdict = verdict_of()
    assert verdict.status == "no_gap"
    assert verdict.where == [] and verdict.causes == []


@pytest.mark.parametrize(
    ("effect", "actuator", "parameters", "stage"),
    [
        ("coulomb_friction", "delta_2", {"force": 0.8}, "motor_mechanics"),
        ("cogging", "delta_1", {"amplitude": 0.5, "periods_per_rev": 6.0}, "motor_mechanics"),
        ("torque_constant", "delta_3", {"relative": 0.3}, "motor_mechanics"),
        ("velocity_deadband", "tilt", {"width": 3e-5}, "drive"),
        ("lead_error", "delta_1", {"relative": 2e-3}, "transmission"),
        ("transmission_ripple", "roll", {"amplitude": 1e-4, "periods_per_rev": 2.0}, "transmission"),
        ("tool_offset", "tip", {"x": 1e-5, "y": -1e-5, "z": 5e-6}, "mechanism"),
        ("structural_compliance", "tip", {"fraction": 0.15}, "structure"),
        ("force_bias", "force_sensor", {"fx": 0.05, "fz": -0.03}, "sensing"),
        ("command_delay", "all", {"delay": 0.0013}, "transport"),
        ("axis_skew", "tilt", {"skew": 0.0008}, "transport"),
        ("controller_gain", "all", {"relative": 0.1}, "controller"),
    ],
)
def test_a_single_effect_is_found_where_it_is(effect, actuator, parameters, stage):
    verdict = verdict_of(plants()[effect](actuator, **parameters))
    assert verdict.status == "attributed"
    assert verdict.where[0].stage == stage
    cause = verdict.causes[0]
    assert cause.effect == effect
    assert actuator in (cause.actuator, "all", "tip")
    assert verdict.closure.stage.value > 0.9
    for name, value in parameters.items():
        found = cause.parameters[name]
        assert found.value == value if found.low is None else found.low <= value <= found.high


def test_two_effects_in_two_stages_are_both_found():
    verdict = verdict_of(plants()["coulomb_friction"]("delta_2", force=0.8), plants()["tool_offset"]("tip", x=1e-5))
    assert {c.effect for c in verdict.causes} == {"coulomb_friction", "tool_offset"}


def test_without_the_true_effect_and_its_kin_the_gap_is_outside_the_library():
    effects = [plants()["transmission_ripple"]("roll", amplitude=1e-4, periods_per_rev=2.0)]
    verdict = verdict_of(*effects, without=("transmission_ripple",))
    assert verdict.status == "outside_library"
    assert (verdict.unexplained.stage, verdict.unexplained.actuator) == ("transmission", "roll")


def test_an_unknown_effect_cannot_be_left_out():
    with pytest.raises(ValueError, match="no such effect; value gremlins"):
        diagnose_runs([], ROBOT, ("gremlins",))
