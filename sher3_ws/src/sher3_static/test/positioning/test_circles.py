"""Circles with known errors, and the figures of the standards against numbers worked out by hand."""

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from sher3_static.positioning.description import PositioningDescription
from sher3_static.positioning.iso import circular, positioning
from sher3_static.positioning.kind import KIND
from sher3_static.positioning.reading import read_tests

RADIUS = 0.1
DESCRIPTION = PositioningDescription.model_validate(
    {
        "kind": "positioning",
        "name": "test",
        "planes": [
            {
                "name": "xy",
                "x": {"column": "x", "unit": "m"},
                "y": {"column": "y", "unit": "m"},
                "radius": RADIUS,
            }
        ],
    }
)


def ring(square=0.0, mismatch=0.0, lag_x=0.0, sense=1, seed=1):
    """Points of a circle with these errors, off centre and with a tenth of a micrometre of noise; m."""
    angle = sense * np.linspace(0.01, 2 * np.pi + 0.01, 360, endpoint=False)
    x, y = RADIUS * np.cos(angle), RADIUS * np.sin(angle)
    moving = np.sign(-np.sin(angle) * sense)
    noise = np.random.default_rng(seed).normal(0.0, 1e-7, (2, len(angle)))
    return {
        "x": 2e-5 + (1 + mismatch / 2) * x - square * y - lag_x / 2 * moving + noise[0],
        "y": -1e-5 + (1 - mismatch / 2) * y + noise[1],
    }


def verdict_of(**errors):
    runs = [read_tests(f"turn {s}", ring(sense=s, seed=s + 2, **errors), DESCRIPTION) for s in (1, -1)]
    return diagnose(KIND.machine(DESCRIPTION), runs).verdict


@pytest.mark.parametrize(
    ("errors", "effect", "site", "parameter"),
    [
        ({"square": 50e-6}, "squareness", "xy", "angle"),
        ({"mismatch": 40e-6}, "scale_mismatch", "xy", "relative"),
        ({"lag_x": 4e-6}, "backlash", "xy.x", "width"),
    ],
)
def test_each_error_of_a_circle_is_found(errors, effect, site, parameter):
    verdict = verdict_of(**errors)
    (cause,) = verdict.causes
    assert (cause.effect, cause.actuator) == (effect, site)
    assert cause.parameters[parameter].value == pytest.approx(next(iter(errors.values())), rel=0.1)
    assert any("ISO 230-4" in note for note in verdict.notes)


def test_a_true_circle_has_no_gap():
    assert verdict_of().status == "no_gap"


def test_a_circle_of_another_size_is_refused():
    data = {name: 1e3 * x for name, x in ring().items()}
    with pytest.raises(MachineError, match="no circle of the stated radius"):
        read_tests("a", data, DESCRIPTION)


def test_the_figures_of_iso_230_2_by_hand():
    """Two targets, two cycles: means 1, 5 up and -1, 1 down; spreads of sqrt 2 where readings are 1 either side."""
    target = np.repeat([0.0, 1.0], 4)
    direction = np.tile([1.0, 1.0, -1.0, -1.0], 2)
    deviation = np.array([0.0, 2.0, -1.0, -1.0, 5.0, 5.0, 1.0, 1.0])
    found = positioning(target, deviation, direction)
    s = np.sqrt(2.0)
    assert found.reversal == pytest.approx(4.0) and found.mean == pytest.approx(3.0)
    assert found.systematic == pytest.approx(6.0)
    assert found.accuracy == pytest.approx(5.0 - (1.0 - 2.0 * s) if 1.0 - 2.0 * s < -1.0 else 6.0)
    assert found.repeatability == pytest.approx(max(4.0 * s, 2.0 * s + 2.0, 4.0))


def test_the_figures_of_iso_230_4_by_hand():
    angle = np.linspace(0.0, 2 * np.pi, 400, endpoint=False)
    radius = 1.0 + 3e-6 * np.cos(angle) + 2e-6 * np.sin(2 * angle)
    found = circular(angle, radius, np.ones(400))
    assert found.both == pytest.approx(4e-6, rel=1e-3) and found.forward == found.both and np.isnan(found.backward)


def test_a_ball_bar_gives_angle_and_deviation():
    plane = {"name": "xy", "angle": {"column": "a", "unit": "deg"}, "deviation": {"column": "r", "unit": "um"}}
    text = {"kind": "positioning", "name": "bar", "planes": [{**plane, "radius": RADIUS}]}
    described = PositioningDescription.model_validate(text)
    runs = []
    for sense in (1, -1):
        angle = sense * np.arange(0.0, 360.0, 0.5)
        noise = np.random.default_rng(7 + sense).normal(0.0, 0.2, len(angle))
        across, moving = np.sin(np.radians(angle)), np.sign(sense * np.cos(np.radians(angle)))
        data = {"a": angle % 360.0, "r": 2.0 * np.cos(np.radians(angle)) - 4.0 * across * moving + noise}
        runs.append(read_tests(f"turn {sense}", data, described))
    (cause,) = diagnose(KIND.machine(described), runs).verdict.causes
    assert cause.effect == "backlash" and cause.actuator == "xy.y"
    assert cause.parameters["width"].value == pytest.approx(8e-6, rel=0.1)
    (line,) = [n for n in diagnose(KIND.machine(described), runs).verdict.notes if "contribution 1" in n]
    assert float(line.split("G(b) ")[1].split(",")[0]) < 2.0, line
    with pytest.raises(ValueError, match="either `x` and `y`, or `angle` and `deviation`"):
        PositioningDescription.model_validate(
            {**text, "planes": [{"name": "xy", "angle": plane["angle"], "radius": RADIUS}]}
        )
