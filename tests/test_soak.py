"""The soak of `bench/soak.py` in its short form, and what it would call growth."""

import importlib.util
import json
import subprocess
import sys

import numpy as np
import pytest
from processes import child_environment
from sources import ROOT

SCRIPT = ROOT / "bench" / "soak.py"


@pytest.fixture(scope="module")
def soak():
    spec = importlib.util.spec_from_file_location("soak", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    sys.modules["soak"] = module
    spec.loader.exec_module(module)
    yield module
    del sys.modules["soak"]


def run(seconds: float, domain: int, timeout: float) -> dict:
    command = [sys.executable, str(SCRIPT), "--seconds", str(seconds), "--json", "--any-state", "--domain", str(domain)]
    done = subprocess.run(
        command, env=child_environment(), capture_output=True, text=True, timeout=timeout, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def check(result: dict) -> None:
    assert result["faults"] == [] and result["leftovers"] == []
    assert len(result["processes"]) == 11 and len(result["nodes"]) == 10
    for name, process in result["processes"].items():
        assert process["files"][0] >= process["files"][1] > 3, name
        assert process["threads"][0] >= process["threads"][1] >= 1, name
        assert 10 < process["rss_mb"] < 1000, name
    # The whole graph ran: most of its cycles took place, and they were recorded.
    assert result["nodes"]["motor_driver"]["period"]["count"] > 0.5 * result["seconds"] * result["rate"]
    assert result["recording"]["bytes"] > 10_000 * result["seconds"]


@pytest.mark.graph
@pytest.mark.flaky(reruns=2)
def test_a_short_soak_leaves_nothing_behind(domain):
    check(run(6.0, domain, 150.0))


@pytest.mark.slow
@pytest.mark.graph
def test_a_soak_of_two_minutes(domain):
    check(run(120.0, domain, 280.0))


def test_a_leak_is_seen_and_noise_is_not(soak):
    """A leak of 1 kB per tick is 1.8 GB/h; a heap that wobbles by a megabyte is none."""
    seconds = np.arange(0.0, 600.0)
    wobble = np.random.default_rng(3).normal(0.0, 1.0, 600)
    slope, low, high = soak.growth(seconds, 100.0 + 36.0 * seconds / 3600.0 + wobble)
    assert low < 36.0 < high and slope == pytest.approx(36.0, abs=10.0)

    def verdict(rss, files=None, threads=None):
        n = len(rss)
        made = soak.Samples(list(seconds[:n]), list(rss), files or [9] * n, threads or [3] * n)
        return made.verdict()["grew"]

    assert verdict(100.0 + 0.5 * seconds)
    assert verdict(100.0 + 40.0 * seconds / 3600.0)
    assert not verdict(100.0 + wobble)
    assert not verdict(100.0 + 0.1 * seconds[:20])  # one allocation early in a short run
    assert verdict(100.0 + wobble, files=[9] * 599 + [10])
    assert verdict(100.0 + wobble, threads=[3] * 300 + [4] * 300)


def test_what_stays_behind_is_found(soak, domain):
    import socket

    from sher3_bringup.settings.run_settings import MOCK_FORCE_PORT

    before = soak.places(domain)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", MOCK_FORCE_PORT + 250 * domain))
        child = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
        try:
            found = soak.left_behind(before, domain)
        finally:
            child.communicate(b"\n")
    assert "the port of the mock force sensor" in found and any(str(child.pid) in what for what in found)
