"""Cameras, definitions and robots as built: each against a number known beforehand."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_benchtop.as_built import FILE, Tolerances, as_built
from sher3_benchtop.cameras.camera import Camera, view
from sher3_benchtop.evaluation.evaluate import evaluate
from sher3_benchtop.evaluation.measures import iso9283, motion_errors, repeatability, slope
from sher3_benchtop.evaluation.spread import at_rest
from sher3_benchtop.fixture import bench_robot
from sher3_benchtop.protocol.plan import ACCURACY
from sher3_description import load_robot
from sher3_effects import load_effects, plants

ROBOT = bench_robot(load_robot())
POINTS = ACCURACY.points


def accuracy(effects) -> dict[str, float]:
    """Return the accuracy table [um] of a robot at rest, keyed `motion axis`."""
    figures = evaluate({"grid_10mm": at_rest(ROBOT, effects)}, "tip")
    parts = {name: name.split("/") for name in figures if name.endswith("mean")}
    return {f"{p[1][0]} {p[2]}": figures[name] for name, p in parts.items()}


@pytest.mark.parametrize("name", ["10mm", "2mm"])
def test_views_make_sense_only_with_units_and_views_corrected(name):
    """A 12 MP sensor has some 2500 to 4000 pixels along the view."""
    chosen = view(name)
    assert 2000 < chosen.width / chosen.pixel < 4000
    assert chosen.rms < 20e-6


@pytest.mark.parametrize("count", [21, 201])
def test_distortion_has_the_printed_rms_and_no_affine_part(count):
    """On the calibration's own points, and nearly so on others: a calibration against a stage took the rest."""
    chosen = view("10mm")
    line = np.linspace(-0.5, 0.5, count) * chosen.width
    places = np.array([(x, y) for x in line for y in line])
    error, slack = Camera(chosen, "field", seed=3).distortion(places), 0.0 if count == 21 else 0.2
    assert np.sqrt((error**2).mean(axis=0)) == pytest.approx([chosen.rms] * 2, rel=slack + 1e-9)
    affine = np.column_stack((np.ones(len(places)), 2.0 * places / chosen.width))
    assert np.abs(np.linalg.lstsq(affine, error, rcond=None)[0]).max() < (slack + 1e-9) * chosen.rms


def test_readings_are_whole_pixels_and_repeat_only_with_a_fixed_distortion():
    chosen, places = view("2mm"), np.full((500, 2), 0.3e-3)
    for reading, spread in (("field", 0.0), ("noise", chosen.rms)):
        read = Camera(chosen, reading, seed=1).read(places)
        assert read / chosen.pixel == pytest.approx(np.round(read / chosen.pixel), abs=1e-6)
        assert read.std(axis=0) == pytest.approx([spread] * 2, rel=0.15)
    assert Camera(chosen, "tip").read(places) is places


def test_motion_errors_of_a_stretched_and_turned_grid():
    """Stretching by 0.2 % is 10 um in 5 mm; turning by 1 mrad is 5 um across."""
    turned = POINTS @ np.array([[1.002, 1e-3], [-1e-3, 1.002]])
    errors = motion_errors(turned, POINTS, 0, ACCURACY.spacing)
    assert len(errors) == 6
    assert errors == pytest.approx(np.tile([10e-6, 5e-6], (6, 1)), rel=1e-9)


def test_repeatability_and_iso_of_known_visits():
    """Two targets, visits at +-3 um in one axis: standard deviation 3 sqrt(4/3), RP the distance itself."""
    offsets = np.array([[3e-6, 0.0], [-3e-6, 0.0], [3e-6, 0.0], [-3e-6, 0.0]])
    targets = np.array([[0.0, 0.0], [1e-3, 0.0]])
    number = np.repeat([0, 1], 4)
    places = targets[number] + np.tile(offsets, (2, 1)) + np.array([7e-6, 0.0]) * number[:, None]
    assert repeatability(places, number) == pytest.approx([3e-6 * np.sqrt(4 / 3), 0.0])
    found = iso9283(places, number, targets)
    assert found.repeatability == pytest.approx([3e-6, 3e-6])
    assert found.accuracy == pytest.approx([3.5e-6, 3.5e-6])


def test_slope_ignores_an_offset():
    force = np.array([0.0, 8.0, -6.0, 8.0])
    assert slope(force, 3e-4 * force + 1.0) == pytest.approx(3e-4)


def test_the_nominal_robot_is_within_its_encoders():
    """A count is 0.24 um of slider; the tip moves at most about twice as much as the worst one."""
    assert max(accuracy([]).values()) < 0.5


def test_a_scale_error_shows_along_z_alone():
    """Encoders that read 0.2 % too much make 5 mm 10 um too short; equal sliders move the tip straight up."""
    effects = [plants()["encoder_scale"](axis, relative=2e-3) for axis in ("delta_1", "delta_2", "delta_3")]
    found = accuracy(effects)
    assert found["z z"] == pytest.approx(5e3 * 2e-3 / 1.002, abs=0.3)
    assert max(found["z x"], found["z y"]) < 0.5


def test_rails_that_lean_together_carry_the_tip_sideways():
    lean = np.radians(0.25)
    azimuths = ROBOT.delta.leg_azimuth
    effects = [plants()["rail_tilt"](f"delta_{k + 1}", angle=lean, azimuth=-a) for k, a in enumerate(azimuths)]
    found = accuracy(effects)
    assert found["z x"] == pytest.approx(5e3 * np.sin(lean), rel=0.02)
    assert found["z y"] < 0.5


def test_links_and_balls_leave_a_vertical_motion_true():
    """Equal slider motions move the platform rigidly whatever its links: the printed z errors need rails or scales."""
    alone = as_built(5, Tolerances(rail_lean=0.0, encoder_scale=0.0))
    found = accuracy(alone)
    assert max(found["z x"], found["z y"], found["z z"]) < 0.5
    assert found["y y"] > 5.0


def test_the_default_robot_is_the_first_draw():
    assert load_effects(FILE) == as_built(0)


def test_draws_have_the_stated_tolerances():
    drawn = [e for seed in range(300) for e in as_built(seed)]
    difference = [e.difference for e in drawn if e.id == "link_length_error"]
    lean = [e.angle for e in drawn if e.id == "rail_tilt"]
    assert np.std(difference) == pytest.approx(50e-6 * np.sqrt(6), rel=0.08)
    assert np.sqrt(np.mean(np.square(lean)) / 2) == pytest.approx(np.radians(0.25), rel=0.08)
