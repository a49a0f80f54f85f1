"""Positioning tests with known errors: each is found, with its size and its share of the standard's figures."""

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from sher3_static.positioning.description import PositioningDescription
from sher3_static.positioning.kind import KIND
from sher3_static.positioning.reading import cycles, directions, read_tests

TARGETS = np.linspace(0.0, 0.5, 11)
NOISE = 0.3e-6


def table(cycles=5, targets=TARGETS, scale=0.0, reversal=0.0, growth=0.0, drift=0.0, bump=0.0, ripple=0.0, seed=1, **_):
    """Rows of a test as a machine with these errors gives them; m."""
    there = np.concatenate([targets, targets[::-1]])
    target, side = np.tile(there, cycles), np.tile(np.repeat([1.0, -1.0], len(targets)), cycles)
    warm = np.linspace(0.0, 4.0, len(target))
    middle = target - 0.25
    deviation = scale * middle - side * reversal / 2 + growth * warm * middle + drift * np.linspace(0, 1, len(target))
    deviation += bump * np.exp(-(((target - 0.35) / 0.06) ** 2)) + ripple * np.sin(2 * np.pi * target / 0.2)
    deviation += 3e-6 + np.random.default_rng(seed).normal(0.0, NOISE, len(target))
    return {"target": target, "reading": target + deviation, "temperature": 20.0 + warm}


def description(**changes):
    axis = {
        "name": "x",
        "target": {"column": "target", "unit": "m"},
        "reading": {"column": "reading", "unit": "m"},
        "temperature": {"column": "temperature", "unit": "1"},
        **changes,
    }
    axis = {k: v for k, v in axis.items() if v is not None}
    return PositioningDescription.model_validate({"kind": "positioning", "name": "test", "axes": [axis]})


def verdict_of(data, **changes):
    described = description(**changes)
    return diagnose(KIND.machine(described), [read_tests("a", data, described)]).verdict


def found(verdict):
    return {c.effect: {name: p.value for name, p in c.parameters.items()} for c in verdict.causes}


def test_a_table_of_forces_is_no_positioning_test():
    columns = {"target": {"column": "applied", "unit": "N"}, "reading": {"column": "read", "unit": "N"}}
    with pytest.raises(ValueError, match=r"'applied' is in N.*force_sensor"):
        PositioningDescription.model_validate({"kind": "positioning", "name": "x", "axes": [{"name": "x", **columns}]})


def test_a_healthy_table_has_no_gap():
    alarms = sum(verdict_of(table(seed=seed)).status != "no_gap" for seed in range(10))
    assert alarms <= 1


@pytest.mark.parametrize(
    ("errors", "effect", "parameter", "value"),
    [
        ({"scale": 20e-6}, "lead_error", "relative", 20e-6),
        ({"reversal": 6e-6}, "backlash", "width", 6e-6),
        ({"growth": 11e-6}, "thermal_expansion", "coefficient", 11e-6),
        ({"drift": 5e-6}, "position_drift", "over_test", 5e-6),
        ({"bump": 5e-6}, "position_error_map", "range", 5e-6),
        ({"ripple": 3e-6, "lead": 0.2}, "transmission_ripple", "amplitude", 3e-6),
    ],
)
def test_each_error_is_found_with_its_size(errors, effect, parameter, value):
    verdict = verdict_of(table(**errors), **({"lead": errors["lead"]} if "lead" in errors else {}))
    assert verdict.status == "attributed" and list(found(verdict)) == [effect]
    assert found(verdict)[effect][parameter] == pytest.approx(value, rel=0.15)


def test_a_mirrored_table_has_the_same_causes_with_the_other_sign():
    """Overshoot instead of lost motion: many controllers take off more than the gap, and some references count back."""
    errors = {"scale": 40e-6, "reversal": 6e-6, "drift": 5e-6}
    for seed in range(3):
        data = table(**errors, seed=seed)
        mirrored = {**data, "reading": 2.0 * data["target"] - data["reading"]}
        one, other = found(verdict_of(data)), found(verdict_of(mirrored))
        assert set(one) == set(other) == {"lead_error", "backlash", "position_drift"}
        for effect, values in one.items():
            assert [-x for x in values.values()] == pytest.approx(list(other[effect].values()), rel=1e-6)


def test_a_bent_guide_is_a_map_and_no_lead_error():
    """Its line through the ends has a slope of its own, which no lead has: the map departs from the best line."""
    for seed in range(5):
        data = table(seed=seed)
        bent = 40e-6 * np.random.default_rng(seed).normal(size=len(TARGETS)).cumsum() / len(TARGETS)
        bent -= np.polyval(np.polyfit(TARGETS, bent, 1), TARGETS)
        data["reading"] = data["reading"] + np.interp(data["target"], TARGETS, bent)
        causes = found(verdict_of(data))
        assert list(causes) == ["position_error_map"]
        assert causes["position_error_map"]["range"] == pytest.approx(np.ptp(bent), abs=1.5e-6)


def test_a_drift_that_settles_is_a_drift():
    data = table()
    settling = 12e-6 * -np.expm1(-np.linspace(0.0, 5.0, len(data["target"])))
    data["reading"] = data["reading"] + settling
    (cause,) = verdict_of(data).causes
    assert cause.effect == "position_drift"
    assert cause.parameters["over_test"].value == pytest.approx(12e-6, rel=0.05)
    assert cause.parameters["settling"].value == pytest.approx(0.2, rel=0.15)


def test_a_screw_grows_from_its_fixed_bearing():
    """Held at 0: the middle of the travel wanders too, which is no drift of its own. Targets count from the middle."""
    data = table(growth=11e-6)
    data["reading"] = data["reading"] + 11e-6 * (data["temperature"] - 20.0) * 0.25
    (cause,) = verdict_of(data).causes
    assert cause.effect == "thermal_expansion"
    assert cause.parameters["coefficient"].value == pytest.approx(11e-6, rel=0.05)
    assert cause.parameters["rest"].value == pytest.approx(-0.25, abs=0.02)


def test_several_errors_are_ranked_in_the_standards_figures():
    verdict = verdict_of(table(scale=40e-6, reversal=6e-6))
    assert set(found(verdict)) == {"lead_error", "backlash"}
    lines = [n for n in verdict.notes if "contribution" in n]
    assert "lead_error" in lines[0] and "backlash" in lines[1]
    figures = next(n for n in verdict.notes if "ISO 230-2" in n)
    values = dict(part.split() for part in figures.split("um: ")[1].split(", "))
    assert float(values["B"]) == pytest.approx(6.0, abs=0.6) and float(values["M"]) == pytest.approx(20.0, abs=1.0)
    assert float(values["E"]) == pytest.approx(26.0, abs=1.0) and float(values["A"]) > float(values["E"])


def test_four_errors_at_once():
    verdict = verdict_of(table(scale=40e-6, reversal=6e-6, drift=5e-6, bump=5e-6))
    assert set(found(verdict)) == {"lead_error", "backlash", "position_drift", "position_error_map"}


def test_twenty_rows_are_enough():
    small = table(cycles=2, targets=np.linspace(0.0, 0.5, 5), reversal=6e-6)
    assert len(small["target"]) == 20
    assert list(found(verdict_of(small))) == ["backlash"]
    with pytest.raises(MachineError, match=r"too few rows; value 19; limit 20"):
        verdict_of({name: x[:-1] for name, x in small.items()})


def test_scale_and_expansion_at_one_temperature_are_rivals():
    data = table(scale=20e-6)
    data["temperature"] = np.full(len(data["target"]), 24.0)
    (cause,) = verdict_of(data).causes
    assert {cause.effect, *cause.rivals} == {"lead_error", "thermal_expansion"}


def test_one_cycle_needs_its_noise_stated():
    data = table(cycles=1, targets=np.linspace(0.0, 0.5, 12), reversal=6e-6)
    with pytest.raises(MachineError, match="state `noise`"):
        verdict_of(data)
    assert list(found(verdict_of(data, noise=NOISE))) == ["backlash"]


def test_units_that_differ_are_refused():
    data = table(scale=20e-6)
    with pytest.raises(MachineError, match=r"reading deviates.*row.*units"):
        verdict_of(data, target={"column": "target", "unit": "mm"})


def test_directions_and_cycles_come_from_the_order_of_rows():
    target = np.array([0.0, 1.0, 2.0, 2.0, 1.0, 0.0, 0.0, 1.0])
    assert directions(target).tolist() == [1, 1, 1, -1, -1, -1, 1, 1]
    assert cycles(target, directions(target)).tolist() == [0, 0, 0, 0, 0, 0, 1, 1]


def test_a_table_with_a_column_for_each_pass():
    """As test protocols have it: a row for each target, columns up 1, down 1, up 2, ..."""
    long = table(cycles=3, reversal=6e-6)
    deviation = (long["reading"] - long["target"]).reshape(6, len(TARGETS))
    wide = {f"p{k}": x if k % 2 == 0 else x[::-1] for k, x in enumerate(deviation)} | {"target": TARGETS}
    passes = [{"column": f"p{k}", "unit": "m"} for k in range(6)]
    verdict = verdict_of(wide, reading=None, temperature=None, passes=passes)
    assert found(verdict)["backlash"]["width"] == pytest.approx(6e-6, rel=0.1) and len(verdict.causes) == 1
    with pytest.raises(ValueError, match="either `reading`, `deviation` or `passes`"):
        description(passes=passes)


def test_an_encoder_that_counts_from_elsewhere_is_read_from_there():
    """5.12 m off, as an absolute encoder is; in mm it would be a wrong unit."""
    data = table(scale=40e-6)
    away = {**data, "reading": data["reading"] + 5.12}
    described = description()
    run = read_tests("a", away, described)
    assert any("its reading counts from 5.12" in note and "taken off" in note for note in run.notes)
    (cause,) = diagnose(KIND.machine(described), [run]).verdict.causes
    assert cause.effect == "lead_error" and cause.parameters["relative"].value == pytest.approx(40e-6, rel=0.01)
    with pytest.raises(MachineError, match="correct the units"):
        read_tests("a", {**data, "reading": 1e3 * data["reading"]}, described)
