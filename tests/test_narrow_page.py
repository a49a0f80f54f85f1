"""A page of a recording on a telephone: robot and player come first, tables after them."""

from __future__ import annotations

import numpy as np
import pytest
from browser import CHROMIUM, browse
from robot_rig import ROBOT
from sher3_bags.figures.analysis import analyse
from sher3_sim import simulate
from sher3_view.figures import write_figures

pytestmark = [
    pytest.mark.flaky(reruns=2),
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: nobody has looked at the narrow page"),
]
TOP = "document.querySelector('{}').getBoundingClientRect().top"


def test_the_player_stands_before_the_tables(tmp_path):
    run = simulate(ROBOT, np.zeros((200, 5)), np.zeros((200, 6)), seed=1)
    page = write_figures(run, analyse(run, ROBOT), tmp_path / "summary.html", ROBOT)
    with browse(page.as_uri(), tmp_path / "profile", (420, 900)) as browser:
        browser.call("Emulation.setDeviceMetricsOverride", width=420, height=900, deviceScaleFactor=1, mobile=True)
        assert browser.wait(lambda: browser.evaluate("document.querySelector('.figures') !== null"))
        stage, player, tables = (browser.evaluate(TOP.format(name)) for name in ("#stage", "#play", ".figures"))
        wide = browser.evaluate("document.documentElement.scrollWidth")
        browser.screenshot(tmp_path / "narrow.png")
    assert stage < player < tables
    assert wide <= 420, f"{wide} px wide"
