"""The report of an axis: the engine's page with the axis' own words."""

import pytest
from sher3_diagnosis import diagnose
from sher3_diagnosis.report.page import render
from slides import driven, machine, run_of


@pytest.fixture(scope="module")
def found():
    return diagnose(machine(), [run_of(driven(coulomb=15.0))])


def test_the_data_are_counted(found):
    evidence = found.findings[0].evidence
    reporter = found.machine.reporter()
    assert reporter.data([evidence]) == "1 record, 16 s of slide"
    assert reporter.run_name(evidence, 3) == "Record run"
    assert list(reporter.together(evidence, 3)) == list(range(len(evidence.excitations)))


def test_the_page_has_the_axis(found):
    page = render(found, "slide")
    assert "<h1>Coulomb friction on slide" in page
    assert "force [N]" in page and "held out: the correction was fitted to the other blocks" in page
    assert "sher3 gap apply" not in page and "your own simulator" in page
