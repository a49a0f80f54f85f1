"""Channels that say nothing are named and left out."""

import numpy as np
import pytest
from sher3_chain.readings.wrong import stays_over, stuck, wrong_readings
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from slides import axis_of, columns, driven, machine, run_of

LOADED = {"signals": {**columns("position", "reference", "load"), **columns("command", unit="N")}}


@pytest.fixture(scope="module")
def rows():
    return driven(seconds=8.0, coulomb=5.0)


def test_a_reading_that_stays_while_the_axis_moves():
    moving = np.ones(100, dtype=bool)
    live = np.sin(np.arange(100.0))
    assert stuck(live, moving) is None
    assert "reads 0 in 100%" in stuck(np.zeros(100), moving)
    assert "reads 0 in 60%" in stuck(np.where(np.arange(100) % 5 < 3, 0.0, live), moving)
    assert stuck(np.where(live > 0.0, live.max(), live), moving) is None, "a limit is no dead channel"


def test_an_encoder_that_is_not_connected_is_no_lead_error(rows):
    verdict = diagnose(machine(**LOADED), [run_of(rows, load=np.zeros(len(rows)))]).verdict
    assert {c.effect for c in verdict.causes} == {"coulomb_friction"}
    assert any("slide.load reads 0 in 100%" in n for n in verdict.notes)


def test_an_encoder_that_only_shows_noise_is_dead(rows):
    noise = 1e-6 * np.random.default_rng(0).normal(size=len(rows))
    dead = wrong_readings(run_of(rows, load=noise), axis_of(**LOADED))
    assert "moves by" in dead["load"]


def test_an_effort_of_zero_is_no_mass_problem(rows):
    signals = {**columns("position"), **columns("effort", unit="N")}
    run = run_of(rows, effort=np.zeros(len(rows)))
    del run.signals["slide"]["command"], run.signals["slide"]["reference"]
    with pytest.raises(MachineError, match=r"slide.effort reads 0 in 100%"):
        diagnose(machine(signals=signals, mass="unknown"), [run])


def test_a_position_that_never_moves_is_named(rows):
    still = rows.copy()
    still[:, 0] = 0.0
    assert "reads 0 throughout while reference moves" in wrong_readings(run_of(still), axis_of())["position"]


def test_an_axis_at_rest_is_not_dead(rows):
    still = rows.copy()
    still[:] = 0.01
    assert wrong_readings(run_of(still, load=np.zeros(len(rows))), axis_of(**LOADED)) == {}


WAYS = {
    "above a level": lambda q: np.minimum(q, 0.02),
    "from a moment on": lambda q: np.where(np.arange(len(q)) < 0.8 * len(q), q, q[int(0.8 * len(q))]),
}


@pytest.mark.parametrize("way", WAYS)
def test_an_encoder_that_falls_flat_is_named_and_left_out(rows, way):
    """Its axis is judged by the first one, and nothing of it lies outside the library."""
    verdict = diagnose(machine(**LOADED), [run_of(rows, load=WAYS[way](rows[:, 0]))]).verdict
    assert any("slide.load stays at one reading while the axis moves over" in n for n in verdict.notes)
    assert verdict.status == "attributed" and {c.effect for c in verdict.causes} == {"coulomb_friction"}


def test_a_play_of_a_quarter_of_the_travel_is_no_flat_encoder():
    """Its load rests after the motor has turned round, also where the motor turns back within the gap."""
    t = np.arange(0.0, 20.0, 0.002)
    q = 2e-3 * np.sin(1.7 * t) + 0.6e-3 * np.sin(7.1 * t)
    load, width = np.empty_like(q), 1.3e-3
    load[0] = q[0]
    for k in range(1, len(q)):
        load[k] = min(max(load[k - 1], q[k] - width / 2), q[k] + width / 2)
    assert stays_over(load, q) == 0.0
    assert stays_over(np.maximum(q, -1e-3), q) > 0.2


@pytest.mark.parametrize("seed", range(5))
def test_an_effort_that_was_set_in_steps_is_not_dead(rows, seed):
    """One level may be half of the record; noise about one level, and flickers beside it, are no steps."""
    draw = np.random.default_rng(seed)
    first = int(draw.uniform(0.5, 0.8) * len(rows))
    effort = np.where(np.arange(len(rows)) < first, *draw.uniform(-2.0, 2.0, 2))
    assert "effort" not in wrong_readings(run_of(rows, effort=effort), axis_of())
    flickers = np.where(draw.random(len(rows)) < 0.1, draw.normal(size=len(rows)), effort[0])
    assert "dead channel" in wrong_readings(run_of(rows, effort=flickers), axis_of())["effort"]
