"""The report of an arm in motion: its data, its efforts over time, and no command that would refuse it."""

from lifts import friction, machine, motion, needed, run_of
from sher3_diagnosis import diagnose
from sher3_diagnosis.report.page import render


def test_the_page_shows_the_effort_of_every_joint(tmp_path):
    q, v, a = motion(8.0)
    run = run_of(q, needed(q, v, a) + friction(v, (8.0, 0.5)))
    page = render(diagnose(machine(tmp_path / "lift.urdf"), [run]), "lift")
    assert "1 record, 8 s of 2 joints" in page
    assert "effort [N]" in page and "effort [N·m]" in page
    assert "sher3 gap apply" not in page
