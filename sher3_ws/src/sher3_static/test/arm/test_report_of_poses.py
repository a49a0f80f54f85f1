"""The report of a serial arm: postures instead of time."""

import numpy as np
import pytest
from arms import machine, measured
from sher3_diagnosis import diagnose
from sher3_diagnosis.report.page import render


@pytest.fixture(scope="module")
def found():
    return diagnose(machine(), [measured(np.array([0.0, 0.01, 0.0, 0.0, 0.0, 0.0]))])


def test_every_posture_is_drawn_once(found):
    evidence, reporter = found.findings[0].evidence, found.machine.reporter()
    assert reporter.data([evidence]) == "80 postures, measured from outside"
    masks = [evidence.data.residuals[k][c].ok for k in reporter.together(evidence, 0) for c in evidence.channels]
    assert np.sum(masks, axis=0).tolist() == [1] * 80


def test_the_page_has_the_joint(found):
    page = render(found, "arm")
    assert "<h1>Encoder offset on j2" in page
    assert "measured − nominal pose" in page and ">posture<" in page
