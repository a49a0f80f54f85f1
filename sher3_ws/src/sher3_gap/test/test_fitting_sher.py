"""The held-out loss is that of fits that never saw the run; the timing is read off the echo."""

import numpy as np
import pytest
from sher3_diagnosis.fit.fitting import fit, make_term, solve
from sher3_effects import library, plants
from sher3_gap.evidence import gather
from sher3_gap.stages.exact.timing import timing_of
from simulated import ROBOT, runs_of, signals


@pytest.fixture(scope="module")
def evidence():
    effects = [plants()["coulomb_friction"]("delta_1", force=0.5)]
    return gather(signals(runs_of(("reversals", "sweep"), effects, repeats=2)), ROBOT)


def test_leaving_a_run_out_by_subtraction_is_leaving_it_out(evidence):
    data = evidence.data
    term = make_term(data, library()["coulomb_friction"], "delta_1", {"displacement": 5e-6})
    found = fit(data, [term])
    (channel,) = term.channels
    for held in range(4):
        others = [r for r in range(4) if r != held]
        x = np.concatenate([term.columns[r][channel] for r in others])
        y = np.concatenate([data.target[r][channel] for r in others])
        beta = np.linalg.lstsq(x, y, rcond=None)[0]
        left = data.target[held][channel] - term.columns[held][channel] @ beta
        assert found.loss[held, channel] == pytest.approx(left @ left, rel=1e-6)


def test_collinear_columns_are_solved_and_dead_ones_are_zero():
    x = np.array([[1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [3.0, 3.0, 0.0]])
    beta = solve(x.T @ x, x.T @ np.array([2.0, 4.0, 6.0]))
    assert beta[2] == 0.0
    assert beta[0] + beta[1] == pytest.approx(2.0, rel=1e-6)


@pytest.mark.parametrize("latency", [0.4, 1.0, 2.65])
def test_a_constant_latency_is_read_off_the_echo(latency):
    effects = [plants()["command_delay"]("all", delay=latency * ROBOT.control_period)]
    timing = timing_of(signals(runs_of(("steps",), effects, repeats=1)), ROBOT)
    assert np.median(timing.latency) == pytest.approx(latency, abs=0.02)
    assert timing.constant < 1e-6 * timing.energy
    assert timing.drops == 0.0


def test_drops_are_counted():
    effects = [plants()["dropped_commands"]("all", probability=0.02)]
    timing = timing_of(signals(runs_of(("sweep", "steps"), effects, repeats=2)), ROBOT)
    assert timing.drops == pytest.approx(0.02, rel=0.4)
