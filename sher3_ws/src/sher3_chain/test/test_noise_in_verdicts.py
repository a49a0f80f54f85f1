"""The verdict of axes and arms says how noisy every reading is, in the unit in which the joint is judged."""

import lifts
import numpy as np
import pytest
import slides


def noisy(seed, period, noise=(2e-5, 1e-4), force=0.05, counts=(1e-12, 1e-12)):
    """A lift with a pendulum whose positions and efforts are read with white noise."""
    q, v, a = lifts.motion(period=period)
    rng = np.random.default_rng(seed)
    return lifts.run_of(q + noise * rng.normal(size=q.shape), lifts.needed(q, v, a), period, noise=force, counts=counts)


@pytest.mark.parametrize("period", [0.002, 0.005])
def test_noise_of_the_joints_of_an_arm_comes_back(period, tmp_path):
    machine = lifts.machine(tmp_path / "lift.urdf")
    for seed in range(4):
        found = {(x.actuator, x.reading): (x.deviation, x.unit) for x in machine.noise([noisy(seed, period)])}
        assert {key: unit for key, (_, unit) in found.items()} == {
            ("lift", "position"): "m",
            ("lift", "effort"): "N",
            ("swing", "position"): "rad",
            ("swing", "effort"): "N*m",
        }
        assert [x for x, _ in found.values()] == pytest.approx([2e-5, 0.05, 1e-4, 0.05], rel=0.1)


def test_counts_are_told_as_the_step_beside_the_noise(tmp_path):
    """A count of 1e-4 rad beside noise of as much: 1e-4 * sqrt(1 + 1/12)."""
    found = lifts.machine(tmp_path / "lift.urdf").noise([noisy(1, 0.005, counts=(1e-12, 1e-4))])
    swing = next(x for x in found if (x.actuator, x.reading) == ("swing", "position"))
    assert swing.resolution == pytest.approx(1e-4, rel=1e-6)
    assert swing.deviation == pytest.approx(1e-4 * np.sqrt(13.0 / 12.0), rel=0.1)


def test_an_effort_is_in_newton_metres_by_its_gain_and_else_in_the_recorder_s_unit(tmp_path):
    run = noisy(1, 0.005)
    by_gain = lifts.machine(tmp_path / "a.urdf", joint={"swing": {"gain": -3.0}}).noise([run])[-1]
    assert (by_gain.unit, by_gain.deviation) == ("N*m", pytest.approx(0.15, rel=0.1))
    recorded = lifts.machine(tmp_path / "b.urdf", joint={"swing": {"gain": "unknown"}}).noise([run])[-1]
    assert (recorded.unit, recorded.deviation) == ("eu", pytest.approx(0.05, rel=0.1))


def test_the_verdict_on_an_axis_has_it_and_says_it_in_its_file():
    rng = np.random.default_rng(5)
    rows = slides.driven()
    rows[:, 0] += 5e-6 * rng.normal(size=len(rows))
    verdict = slides.verdict_of(rows)
    assert [(x.actuator, x.reading, x.unit) for x in verdict.noise] == [("slide", "position", "m")]
    assert verdict.noise[0].deviation == pytest.approx(5e-6 * np.hypot(1.0, 0.2 / np.sqrt(12.0)), rel=0.1)
    assert type(verdict).model_validate_json(verdict.to_json()).noise == verdict.noise
