"""Figures of runs whose figures are known."""

import json
from dataclasses import replace

import numpy as np
import pytest
from sher3_bags import BagError, Run, read_run, stream, write_run
from sher3_bags.figures.analysis import analyse
from sher3_bags.figures.compare import compare
from sher3_bags.figures.gaps import GapCounter, count_gaps
from sher3_bags.figures.picture import draw
from sher3_bags.figures.report import analysis_text, comparison_text, quantity

T = 2_000_000
START = 1_700_000_000_000_000_000


def cooperative(n=4000, gain=0.002, deadband=0.1):
    """A tip that follows the force by v = gain deadband(F), with a biased sensor turned by 90 degrees about z."""
    stamp = START + np.arange(n) * T
    t = (stamp - START) * 1e-9
    force = np.stack([np.sin(2.0 * t), 0.7 * np.sin(3.1 * t + 1), 0.5 * np.cos(1.3 * t)], axis=1)
    pressed = t > 1.0
    force[~pressed] = 0
    size = np.linalg.norm(force, axis=1, keepdims=True)
    velocity = gain * force * np.clip(1 - deadband / np.maximum(size, 1e-9), 0, None)
    position = np.cumsum(velocity, axis=0) * 0.002
    orientation = np.tile([0, 0, np.sqrt(0.5), np.sqrt(0.5)], (n, 1))
    in_sensor = np.array([0.3, -0.2, 0.1]) + np.stack([force[:, 1], -force[:, 0], force[:, 2]], axis=1)
    return Run(
        {
            "measured_cp": stream("measured_cp", stamp, position=position, orientation=orientation),
            "force/measured_cf": stream("force/measured_cf", stamp, force=in_sensor, torque=0 * force),
            "pedal/measured": stream("pedal/measured", stamp, axes=pressed[:, None] * 1.0, buttons=np.zeros((n, 1))),
        }
    )


def test_force_against_velocity_recovers_the_gain():
    fit = analyse(cooperative()).force_velocity
    assert fit.gain == pytest.approx(0.002, rel=0.02)
    assert fit.correlation > 0.99
    assert fit.samples == 3499


def test_a_tare_that_took_the_push_is_said():
    """The force never changes, so the tare takes all of it; the tip moves nevertheless."""
    run = cooperative()
    force = run["force/measured_cf"]
    still = np.tile([0.3, -0.2, 0.1], (len(force), 1))
    run.streams["force/measured_cf"] = stream("force/measured_cf", force.stamp, force=still, torque=0 * still)
    fit = analyse(run).force_velocity
    assert "the tare took" in fit.doubt
    assert "do not trust that line" in analysis_text(analyse(run))
    assert analyse(cooperative()).force_velocity.doubt == ""


def test_tip_path():
    n = 1001
    stamp = START + np.arange(n) * T
    angle = np.linspace(0, 2 * np.pi, n)
    position = 0.01 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    run = Run({"measured_cp": stream("measured_cp", stamp, position=position, orientation=np.eye(4)[[3] * n])})
    tip = analyse(run).tip
    assert tip.length == pytest.approx(0.02 * np.pi, rel=1e-4)
    assert tip.extent == pytest.approx((0.02, 0.02, 0), abs=1e-6)
    assert tip.max_speed == pytest.approx(0.02 * np.pi / 2, rel=0.01)


def test_tracking_matches_by_stamp(build):
    run = build()
    table = run["measured_js"]
    keep = np.r_[0:100, 150:400]
    run.streams["measured_js"] = stream("measured_js", table.stamp[keep], position=table.position[keep])
    errors = analyse(run).position_tracking
    assert [e.actuator for e in errors] == ["delta_1", "delta_2", "delta_3", "roll", "tilt"]
    assert [e.unit for e in errors] == ["m", "m", "m", "rad", "m"]
    for error in errors:
        assert error.mean == pytest.approx(-1e-6)
        assert error.max == pytest.approx(1e-6)


def test_drive_error_in_any_mode():
    n, stuck = 500, 300
    stamp = START + np.arange(n) * T
    velocity = 1e-3 * np.sin(0.02 * np.arange(n))[:, None] * np.ones(5)
    way = np.cumsum(velocity, axis=0) * 0.002 - velocity[0] * 0.002
    way[stuck:, 2] = way[stuck, 2]
    drives = {
        "drives/setpoint_jv": stream("drives/setpoint_jv", stamp, velocity=velocity),
        "drives/measured_js": stream("drives/measured_js", stamp, position=0.01 + way, velocity=0 * velocity),
    }
    analysis = analyse(Run(drives))
    errors = [error.max for error in analysis.drive_tracking]
    expected = np.abs(np.cumsum(velocity[:, 0]) * 0.002 - velocity[0, 0] * 0.002 - way[stuck, 2])[stuck:].max()
    assert errors[2] == pytest.approx(expected)
    assert max(errors[:2] + errors[3:]) < 1e-12
    assert analysis.position_tracking == ()
    assert analysis.velocity_tracking[0].max == pytest.approx(1e-3, rel=0.01)


def test_timing_and_drops(build):
    run = build()
    table = run["setpoint_js"]
    keep = np.delete(np.arange(400), [20, 21, 300])
    run.streams["setpoint_js"] = stream(
        "setpoint_js", table.stamp[keep], position=table.position[keep], log_time=table.stamp[keep] + 250_000
    )
    force = run["force/measured_cf"]
    run.streams["force/measured_cf"] = replace(force, log_time=force.stamp + 100_000)
    timing = analyse(run).topics["setpoint_js"]
    assert (timing.dropped, timing.pauses, timing.disordered, timing.off_grid) == (3, 0, 0, 0)
    assert timing.latency.p50 == timing.latency.max == pytest.approx(250e-6)
    assert timing.from_force.p99 == pytest.approx(150e-6)
    assert timing.period.max == pytest.approx(6e-3)
    assert timing.rate == pytest.approx(496.2, abs=0.1)
    assert analyse(run).topics["servo_jv"].latency is None


def test_gaps_at_once_and_one_by_one_agree():
    rng = np.random.default_rng(3)
    for _ in range(30):
        stamp = np.cumsum(rng.choice([-3, 0, 1, 1, 1, 1, 1, 2, 5, 200], 300)) * T + rng.integers(-9, 9, 300)
        for stamped in (True, False):
            counter = GapCounter(T, stamped)
            for value in stamp.tolist():
                counter.see(value)
            assert counter == count_gaps(stamp, T, stamped)


def test_damage_is_reported_not_refused(build):
    run = build()
    table = run["measured_js"]
    stamp, position = table.stamp.copy(), table.position.copy()
    stamp[5], position[9] = stamp[4], np.nan
    run.streams["measured_js"] = stream("measured_js", stamp, position=position)
    analysis = analyse(run)
    assert analysis.topics["measured_js"].disordered == 1
    assert analysis.topics["measured_js"].not_finite == 5
    assert all(np.isfinite(e.rms) for e in analysis.position_tracking)
    assert "5 values not finite" in analysis_text(analysis)


def test_text_json_and_picture(tmp_path, build):
    path = write_run(tmp_path / "bag", build(1000))
    run = read_run(path)
    analysis = analyse(run)
    assert "position tracking" in analysis_text(analysis)
    json.dumps(analysis.to_dict(), allow_nan=False)
    picture = draw(run, analysis, tmp_path / "run.png")
    assert picture.read_bytes()[:4] == b"\x89PNG"
    assert picture.stat().st_size > 20_000
    draw(Run({}), analyse(Run({})), tmp_path / "empty.png")


def delayed(lag, n=3000, noise=0.0, start=START, mean=0.0):
    rng = np.random.default_rng(5)
    stamp = start + np.arange(n) * T
    t = (stamp - start)[:, None] * 1e-9 - lag
    phase = np.arange(5)
    wave = np.sin(4.0 * t + phase) + 0.5 * np.sin(9.7 * t + 2 * phase)
    return Run(
        {"measured_js": stream("measured_js", stamp, position=wave + mean + noise * rng.normal(size=wave.shape))}
    )


@pytest.mark.parametrize("lag", [0.0, 0.0073, -0.031, 0.2])
@pytest.mark.parametrize("mean", [0.0, 50.0])
def test_a_known_lag_is_recovered(lag, mean):
    result = compare(delayed(0.0), delayed(lag, noise=0.01, mean=mean))
    assert result.alignment == "stamp"
    assert result.lag == pytest.approx(lag, abs=1e-3)
    for axis in result.residuals["measured_js"]["position"]:
        assert axis.mean == pytest.approx(mean, abs=0.2)
        assert axis.rms_aligned == pytest.approx(0.01, rel=0.3)


def test_runs_at_different_times_are_aligned_from_their_starts():
    result = compare(delayed(0.0), delayed(0.01, start=START + 86_400_000_000_000))
    assert result.alignment == "start"
    assert result.lag == pytest.approx(0.01, abs=1e-3)
    with pytest.raises(BagError, match="do not overlap"):
        compare(delayed(0.0), delayed(0.0, start=START + 86_400_000_000_000), alignment="stamp")


def test_a_topic_of_one_run_alone_does_not_shift_the_other():
    one, two = delayed(0.0), delayed(0.0, start=START + 86_400_000_000_000)
    early = stream("temperature", [START + 86_000_000_000_000], temperature=[22.0])
    two.streams["temperature"] = early
    assert compare(one, two).residuals["measured_js"]["position"][0].max < 1e-9


def test_no_lag_where_there_is_none_to_see(build):
    run = delayed(0.0)
    table = run["measured_js"]
    line = Run({"measured_js": stream("measured_js", table.stamp, position=table.seconds()[:, None] * np.ones(5))})
    flat = Run({"measured_js": stream("measured_js", table.stamp, position=np.ones((3000, 5)))})
    for other in (line, flat):
        result = compare(other, other)
        assert result.lag is None
        assert all(axis.rms == 0 for axis in result.residuals["measured_js"]["position"])


def test_orientation_is_compared_whatever_its_sign(build):
    run = build()
    pose = run["measured_cp"]
    other = {**pose.columns, "orientation": -pose.orientation}
    twin = Run({"measured_cp": replace(pose, columns=other)})
    result = compare(run, twin)
    assert all(axis.max == 0 for axis in result.residuals["measured_cp"]["orientation"])
    assert set(result.only_in_a) == set(run.streams) - {"measured_cp"}
    assert "only in a" in comparison_text(result)
    with pytest.raises(BagError, match="no topic in common"):
        compare(delayed(0.0), twin)


def test_quantities():
    texts = [quantity(v, "m") for v in (1.5, 2.5e-3, -3e-6, 4e-9, 2e-11, 0.0, None)]
    assert texts == ["1.5 m", "2.5 mm", "-3 µm", "4 nm", "0.02 nm", "0 m", "-"]


@pytest.mark.shared
def test_practice_repeats_have_no_lag(practice):
    one, two = (read_run(practice / "case_001" / f"run_0{k}") for k in (3, 4))
    result = compare(one, two)
    assert abs(result.lag) < 1e-4
    assert max(axis.rms for axis in result.residuals["measured_js"]["position"][:3]) < 1e-6
    assert analyse(one).dropped == 0
