"""Evidence of one axis: which residuals there are, their units, and blocks that take the place of runs."""

import numpy as np
import pytest
from sher3_chain.axes.evidence import gather_axis, residuals_of, units_of
from sher3_chain.axes.view import AxisView
from sher3_chain.chain.evidence import blocks_of
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.signals import signals_of
from sher3_chain.thresholds import MIN_BLOCK
from sher3_diagnosis.channel import Channel, Residual
from sher3_machines.thresholds import BLOCKS
from slides import axis_of, columns

MOTOR, LINK = Channel("motor_mechanics", "slide"), Channel("transmission", "slide")
SERVO = {
    "motion": "rotary",
    "signals": columns("position", "reference", unit="rad"),
    "command_law": {"kind": "position"},
}


def run(name="run", **signals):
    return AxesRun(name, 0.02, {"slide": signals})


def ramp(n=400, speed=0.5):
    return speed * 0.02 * np.arange(n)


def test_blocks_share_the_samples_that_count():
    """Of 100 samples the last 80 count: eight blocks of ten."""
    ok = np.arange(100) >= 20
    blocks = blocks_of({MOTOR: Residual(np.zeros((100, 1)), ok)}, 8)
    assert [int(b[MOTOR].ok.sum()) for b in blocks] == [10] * 8
    assert np.array_equal(sum(b[MOTOR].ok for b in blocks), ok)
    assert len(blocks_of({MOTOR: Residual(np.zeros((10, 1)), np.ones(10, dtype=bool))}, 8)) == 10 // MIN_BLOCK
    assert blocks_of({}, 8) == []


def test_a_servo_is_judged_by_its_tracking_error():
    found = gather_axis([run(position=ramp() - 0.03, reference=ramp())], axis_of(**SERVO), repeats=False)
    assert found.channels == [MOTOR] and found.units[MOTOR] == "rad"
    assert len(found.views) == BLOCKS and found.excitations == ["run"] * BLOCKS
    values = found.data.residuals[0][MOTOR]
    assert values.values[values.ok] == pytest.approx(0.03)
    assert found.places == {"axis": ("slide",)} and found.rotary == {"slide"}


def test_blocks_of_several_records_are_eight_in_all():
    records = [run(name, position=ramp(), reference=ramp()) for name in "abc"]
    found = gather_axis(records, axis_of(**SERVO), repeats=False)
    assert found.excitations == ["a"] * 3 + ["b"] * 3 + ["c"] * 3
    repeated = gather_axis(records, axis_of(**SERVO), repeats=True)
    assert set(repeated.excitations) == {"repeats"} and len(repeated.records) == 3


def test_a_second_encoder_is_a_channel_of_its_own():
    signals = columns("position", "command", "load")
    axis = axis_of(signals=signals, command_law={"kind": "force"}, mass=None)
    seen = AxisView(signals_of(run(position=ramp(), command=ramp(), load=ramp() + 0.001), axis, "run"), axis, 0.0)
    found = residuals_of(seen)
    assert set(found) == {LINK}  # without a mass there is no force balance
    assert found[LINK].values[found[LINK].ok] == pytest.approx(0.001)


def test_no_mean_of_two_encoders_is_a_gap():
    axis = axis_of(signals=columns("position", "command", "load"), command_law={"kind": "force"}, mass=None)
    found = gather_axis([run(position=ramp(), command=ramp(), load=ramp() + 0.001)], axis, repeats=False)
    assert np.isinf(found.count(LINK))


def test_units_follow_the_motion():
    assert units_of(axis_of()) == {MOTOR: "N", LINK: "m"}
    assert units_of(axis_of(motion="rotary")) == {MOTOR: "N*m", LINK: "rad"}
    assert units_of(axis_of(**SERVO)) == {MOTOR: "rad", LINK: "rad"}


def test_the_share_of_a_mass_that_is_left_out_has_a_number():
    """A speed that hardly changes under friction: a mass needs 0.025 % of the force, which was "0.0%"."""
    speed = 0.5 + 0.2 * np.sin(0.001 * np.arange(4000))
    force = 3.0 + 40.0 * speed + 0.02 * np.random.default_rng(0).normal(size=len(speed))
    driven = axis_of(mass="unknown", encoder_resolution=1e-7)
    found = gather_axis([run(position=0.02 * np.cumsum(speed), effort=force)], driven, False)
    (note,) = [n for n in found.notes if "left out" in n]
    assert 0.0 < float(note.split("at most ")[1].split(" %")[0]) < 0.05
