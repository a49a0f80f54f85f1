"""What a gap looks like: a line at a known frequency, a period of a known turn, a function of known inputs."""

import numpy as np
import pytest
from sher3_diagnosis.judge.remainder import ceiling, dominant_frequency, position_period, remainder
from sher3_diagnosis.quantify.closure import residual_after
from toy import AXIS, ToyRun, evidence_of

CLOCK = np.arange(400) / 100.0


def evidence(law, runs=3):
    made = []
    for k in range(runs):
        noise = np.random.default_rng(k).normal(size=400)
        position = 2.0 * CLOCK + 0.01 * k
        made.append(ToyRun("sweep", noise + law(position), position, np.full(400, 0.5)))
    return evidence_of(made)


def left(found):
    return residual_after(found, found.null(), AXIS)


def test_a_line_is_found_at_its_frequency():
    series = {0: np.sin(2 * np.pi * 12.5 * CLOCK)[:, None]}
    frequency, share = dominant_frequency(series, 100.0)
    assert frequency == pytest.approx(12.5, abs=0.2)
    assert share > 0.95
    assert dominant_frequency({0: np.zeros((400, 1))}, 100.0) == (0.0, 0.0)


def test_a_period_is_told_in_turns_of_the_motor():
    """The lead is 1 m, so three periods per metre are three per revolution."""
    found = evidence(lambda q: 10.0 * np.sin(2 * np.pi * 3.0 * q))
    period, share = position_period(found, AXIS, left(found))
    assert period == 3.0
    assert share == pytest.approx(50.0 / 51.0, abs=0.02)


def test_a_free_function_of_the_inputs_closes_what_depends_on_them():
    found = evidence(lambda q: 10.0 * np.sign(np.sin(2 * np.pi * q / 8.0)))
    assert ceiling(found, AXIS, left(found)) > 0.9
    noise = evidence(lambda q: 0.0 * q)
    assert ceiling(noise, AXIS, left(noise)) == 0.0


def test_the_words_name_regime_line_period_and_ceiling():
    found = evidence(lambda q: 10.0 * np.sin(2 * np.pi * 3.0 * q))
    text = remainder(found, AXIS, found.null())
    assert "repeats 3.00 times per motor revolution" in text
    assert "near 6.1 Hz" in text or "near 5.9 Hz" in text
    assert "a free function of the inputs closes" in text


def test_samples_that_are_no_course_in_time_have_no_frequency():
    found = evidence(lambda q: 10.0 * np.sin(2 * np.pi * 3.0 * q))
    for view in found.views:
        view.rate = None
    assert "Hz" not in remainder(found, AXIS, found.null())
