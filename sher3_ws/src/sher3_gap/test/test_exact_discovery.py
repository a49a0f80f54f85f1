"""Formulas for what commands go through: found by discovery, found again as a page."""

from functools import partial

import numpy as np
import pytest
from recorded import ROBOT, run
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.discover.discover import discover, discover_at
from sher3_diagnosis.finding import Findings
from sher3_effects import add_library
from sher3_effects.found_page import save_found
from sher3_effects.registry import VARIABLE
from sher3_gap.stages.exact.controller import controller_finding
from sher3_gap.stages.exact.evidence import exact_evidence
from sher3_gap.stages.exact.findings import with_pages
from sher3_gap.stages.exact.law import delayed, host_law
from sher3_gap.stages.exact.timing import timing_of
from sher3_gap.stages.exact.transport import transport_finding

TICKS, RUNS = 400, 5


def wave(seed, size):
    """Return (n, 5) waves of three frequencies."""
    rng, t = np.random.default_rng(seed), np.arange(TICKS)[:, None] / 500.0
    parts = [
        a * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.0, 5)) for a, f in ((1.0, 0.7), (0.4, 3.0), (0.1, 11.0))
    ]
    return size * sum(parts)


def sent(passed_on):
    """Return runs whose echo on delta 2 is what becomes of its command."""
    runs = []
    for seed in range(RUNS):
        command = wave(seed, 2e-3)
        echo = delayed(command, 1)
        echo[:, 1] = delayed(passed_on(command)[:, [1]], 1)[:, 0]
        runs.append(run(TICKS, command=command, echo=echo, excitation=f"wave {seed}"))
    return runs


def commanded(extra):
    """Return runs whose host adds something to its command of tilt."""
    runs = []
    for seed in range(RUNS):
        reference, load = wave(seed, 1e-3), wave(seed, 0.98e-3) + wave(seed + 50, 2e-6)
        rate = np.gradient(reference, 1.0 / 500.0, axis=0)
        base = run(TICKS, reference=reference, reference_velocity=rate, load=load, excitation=f"wave {seed}")
        command = host_law(base, ROBOT, ROBOT.position_gain)
        command[:, 4] += extra(reference, load)[:, 4]
        options = {"reference": reference, "reference_velocity": rate, "load": load, "excitation": f"wave {seed}"}
        runs.append(run(TICKS, command=command, **options))
    return runs


def slewed(limit):
    def passed_on(command):
        out, now = np.empty_like(command), np.zeros(5)
        for k in range(len(out)):
            now = out[k] = now + np.clip(command[k] - now, -limit / 500.0, limit / 500.0)
        return out

    return passed_on


def test_a_demand_that_cannot_follow_is_told_with_its_limit():
    found = discover_at(exact_evidence(sent(slewed(0.015)), ROBOT, "transport"), Channel("transport", "delta_2"))
    (term,) = found.terms
    (factor,) = term.feature.factors
    assert (factor.law, factor.quantity) == ("slow", "command")
    assert factor.shape[0] == pytest.approx(0.015, rel=0.01) and term.coefficient.value == pytest.approx(1.0, rel=0.01)
    assert found.closure.value > 0.99
    assert "an extra demand of delta 2 in proportion to the lag of the command" in found.sentences[0]


def earlier(ticks):
    def extra(_, load):
        return ROBOT.position_gain * (load - np.concatenate([load[:1].repeat(ticks, axis=0), load[:-ticks]]))

    return extra


def test_what_comes_by_chance_has_no_formula():
    def by_chance(_, load):
        return 1e-4 * np.random.default_rng(int(1e12 * abs(load[5, 0]))).normal(size=load.shape)

    found = discover_at(exact_evidence(commanded(by_chance), ROBOT, "controller"), Channel("controller", "tilt"))
    assert not found.claimed and found.note == "no formula holds on runs left out"


def asked(runs):
    """Return what a diagnosis that has found nothing else says of the stage of these runs."""
    finding = controller_finding(runs, ROBOT)
    return finding, partial(exact_evidence, runs, ROBOT, "controller")


def test_discovery_asks_the_stage_that_is_named():
    from dataclasses import replace

    finding, gathered = asked(commanded(earlier(2)))
    diagnosis = Findings(None, [], [replace(finding, evidence=gathered)])
    diagnosis.__dict__["verdict"] = type("V", (), {"unexplained": finding.where})()
    assert [str(t.feature) for t in discover(diagnosis).terms] == ["itself(reading.change_2)"]
    assert "does what it is asked to" in discover(diagnosis, Channel("controller", "roll")).note
    whole = discover(diagnosis, Channel("controller", "all"))
    assert whole.channel == Channel("controller", "tilt")


@pytest.fixture(scope="module")
def late():
    """Runs of a host that reads late, and the formula of it."""
    finding, gathered = asked(commanded(earlier(3)))
    evidence = gathered()
    assert evidence.channels == [Channel("controller", "tilt")]  # the others do what they are asked to
    return finding, gathered, discover_at(evidence, evidence.channels[0])


def test_a_host_that_reads_late_is_told_with_its_ticks(late):
    *_, found = late
    assert [str(t.feature) for t in found.terms] == ["itself(reading.change_3)"]
    (value,) = (t.coefficient for t in found.terms)
    assert value.value == pytest.approx(ROBOT.position_gain, rel=1e-6) and value.unit == "1/s"


def test_a_saved_formula_is_found_again(late, tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    finding, gathered, found = late
    assert finding.causes == [] and with_pages(finding, gathered) is finding
    save_found(found, "old_reading", tmp_path / "old.yaml")
    add_library([tmp_path / "old.yaml"])
    again = with_pages(finding, gathered)
    (cause,) = again.causes
    assert (cause.effect, cause.actuator, cause.stage) == ("old_reading", "tilt", "controller")
    assert cause.parameters["coefficient_1"].value == pytest.approx(ROBOT.position_gain, rel=1e-6)
    assert again.closure.value > 0.99
    assert with_pages(finding, gathered, without=["old_reading"]) is finding


def test_a_page_that_does_not_reproduce_the_stage_is_no_cause(late, tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    *_, found = late
    save_found(found, "old_reading", tmp_path / "old.yaml")
    add_library([tmp_path / "old.yaml"])
    other, of_other = asked(commanded(lambda reference, _: 0.02 * np.abs(reference)))
    assert with_pages(other, of_other) is other


def test_where_a_delay_reproduces_the_stage_no_page_is_asked():
    runs = sent(lambda command: delayed(command, 2))
    finding = transport_finding(timing_of(runs, ROBOT), runs, ROBOT)
    assert with_pages(finding, lambda: pytest.fail("not needed")) is finding
