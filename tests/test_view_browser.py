"""The live page of a robot on mocks in a real browser: it draws, it says the state, and its buttons reach the mocks."""

from __future__ import annotations

import socket
import subprocess

import numpy as np
import pytest
from browser import CHROMIUM, browse
from matplotlib.image import imread
from processes import child_environment, sher3_command
from sources import ROOT

pytestmark = [
    pytest.mark.graph,
    pytest.mark.slow,
    pytest.mark.flaky(reruns=2),
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: nobody has looked at the live page"),
]
BLUE = (43, 108, 176)


@pytest.fixture
def address(domain):
    """A robot on mocks with its live page."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    options = ["--patient", "--duration", "150", "--domain", str(domain), "--view", "--view-port", str(port)]
    process = subprocess.Popen(sher3_command("up", *options), env=child_environment())
    try:
        yield f"http://127.0.0.1:{port}"
    finally:
        process.terminate()
        process.wait(30.0)


def share(pixels: np.ndarray, colour: tuple[int, int, int], tolerance: float = 0.16) -> float:
    """Return the share of pixels near a colour."""
    return float((np.abs(pixels - np.array(colour) / 255.0).max(axis=-1) < tolerance).mean())


def test_the_live_page_draws_and_its_buttons_reach_the_mocks(address, tmp_path):
    picture = ROOT / "bags" / "tests" / "live_page.png"
    picture.parent.mkdir(parents=True, exist_ok=True)
    with browse(address, tmp_path / "profile", (1700, 1250)) as page:
        assert page.wait(lambda: "DISABLED" in page.text()), page.text()
        for folder in ("Hand and foot on the mock", "Effects in the mock"):
            assert page.wait(lambda folder=folder: page.click(folder)), folder
        assert page.wait(lambda: page.click("Enable"), 20.0)
        assert page.wait(lambda: "ENABLED" in page.text()), page.text()
        assert page.click("Pedal")
        assert page.wait(lambda: "100%" in page.text()), page.text()
        assert page.fill(0, "1") and page.wait(lambda: "motion is allowed" in page.text()), page.text()
        assert page.click("Put it in") and page.wait(lambda: "backlash on delta_1" in page.text())
        pixels = imread(page.screenshot(picture))[:, :, :3]
        assert page.click("Disable") and page.wait(lambda: "DISABLED" in page.text()), page.text()
        assert not page.errors
    scene = pixels[150:, : pixels.shape[1] * 2 // 3]
    assert share(scene, BLUE) > 0.003, "the sliders of the legs"
    assert 0.02 < (scene.mean(axis=-1) < 0.5).mean() < 0.6, "arm and platform are dark, and the picture is not black"
