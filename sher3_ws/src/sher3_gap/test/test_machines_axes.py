"""Axes simulated here, with an integrator of the test's own: what the engine says of them."""

import numpy as np
import pytest
from sher3_gap.machines.description import AxesMachine
from sher3_gap.machines.diagnose import diagnose_axes
from sher3_gap.machines.intake import AxesRun

PERIOD, MASS, KP, KD, COUNT = 0.002, 12.0, 6.0e4, 1.2e3, 1e-6


def reference(t):
    return 0.04 * np.sin(1.3 * t) + 0.015 * np.sin(4.1 * t + 0.4)


def driven(seconds=16.0, coulomb=0.0, viscous=0.0, offset=0.0, limit=np.inf, fine=20):
    """Position and command of a PD-driven mass with a smoothed friction law, midpoint steps."""
    n, h = int(seconds / PERIOD), PERIOD / fine
    q, v, last = float(reference(0.0)), 0.0, float(reference(0.0))
    rows = np.empty((n, 3))
    for k in range(n):
        read = COUNT * round(q / COUNT)
        u = float(np.clip(KP * (reference(k * PERIOD) - read) - KD * (read - last) / PERIOD, -limit, limit))
        rows[k], last = (read, reference(k * PERIOD), u), read
        for _ in range(fine):
            a = (u - viscous * v - coulomb * np.tanh(v / 2e-4) - offset) / MASS
            q, v = q + h * (v + 0.5 * h * a), v + h * a
    return rows


def machine(**changes):
    axis = {
        "name": "slide",
        "motion": "linear",
        "signals": {x: {"column": x, "unit": u} for x, u in (("position", "m"), ("reference", "m"), ("command", "N"))},
        "command_law": {"kind": "force", "position_gain": KP, "velocity_gain": KD, "held": True},
        "mass": MASS,
        "encoder_resolution": COUNT,
        **changes,
    }
    time = {"rate": 1.0 / PERIOD}
    return AxesMachine.model_validate({"kind": "axes", "name": "test", "time": time, "axes": [axis]})


def run_of(rows, **more):
    signals = dict(zip(("position", "reference", "command"), rows.T, strict=True))
    return AxesRun("run", PERIOD, {"slide": {**signals, **more}})


def verdict_of(rows, without=(), **changes):
    return diagnose_axes(machine(**changes), [run_of(rows)], without, lambda _: None)[0]


@pytest.fixture(scope="module")
def rubbed():
    return driven(coulomb=5.0, viscous=40.0)


def test_healthy_axis_has_no_gap():
    verdict = verdict_of(driven())
    assert verdict.status == "no_gap", verdict


def test_friction_is_found_and_its_force(rubbed):
    verdict = verdict_of(rubbed)
    causes = {c.effect: c for c in verdict.causes}
    assert verdict.status == "attributed"
    assert causes["coulomb_friction"].parameters["force"].value == pytest.approx(5.0, rel=0.06)
    assert causes["viscous_friction"].parameters["extra"].value == pytest.approx(40.0, rel=0.1)
    assert set(causes) == {"coulomb_friction", "viscous_friction"}
    assert verdict.closure.tip.value > 0.95


def test_unknown_mass_is_identified_beside_friction(rubbed):
    verdict = verdict_of(rubbed, mass="unknown")
    note = next(n for n in verdict.notes if "mass identified" in n)
    assert float(note.split(" as ")[1].split()[0]) == pytest.approx(MASS, rel=0.02)
    assert "coulomb_friction" in {c.effect for c in verdict.causes}


def test_left_out_friction_is_not_answered_with_another_family(rubbed):
    families = {"coulomb_friction", "stribeck_friction", "presliding_friction", "viscous_friction"}
    verdict = verdict_of(rubbed, without=families)
    assert verdict.status in ("outside_library", "under_excited")


def test_pinned_command_is_a_limit():
    rows = driven(seconds=8.0, limit=0.9, offset=0.3)
    verdict = verdict_of(rows)
    limits = [c for c in verdict.causes if c.effect == "force_saturation"]
    assert limits and limits[0].parameters["limit"].value == pytest.approx(0.9, rel=0.02)


def test_backlash_needs_the_second_encoder(rubbed):
    q = rubbed[:, 0]
    load, side = np.empty_like(q), q[0]
    for k, x in enumerate(q):
        side = min(max(side, x - 2e-5), x + 2e-5)
        load[k] = COUNT * round(side / COUNT)
    signals = {x: {"column": x, "unit": "m"} for x in ("position", "reference", "load")}
    signals["command"] = {"column": "command", "unit": "N"}
    chain = machine(signals=signals)
    verdict, _ = diagnose_axes(chain, [run_of(rubbed, load=load)], (), lambda _: None)
    backlash = [c for c in verdict.causes if c.effect == "backlash"]
    assert backlash and backlash[0].parameters["width"].value == pytest.approx(4e-5, rel=0.1)
    assert not [c for c in verdict_of(rubbed).causes if c.family == "lost_motion"]


@pytest.mark.parametrize(("lag", "sag", "stick"), [(0.08, 0.0, 0.0), (0.0, 0.03, 0.0), (0.05, 0.02, 0.01)])
def test_servo_lag_sag_and_stiction(lag, sag, stick):
    t = np.arange(0.0, 60.0, 0.02)
    r = 0.4 * np.sin(0.9 * t) + 0.1 * np.sin(2.7 * t)
    q, out = r[0] - sag, np.empty_like(r)
    for k, x in enumerate(r):
        out[k] = q
        error = x - q - sag
        push = error - np.clip(error, -stick, stick)
        q += push * (1.0 - np.exp(-0.02 / lag)) if lag else push
    count = 1.5e-3
    signals = {x: {"column": x, "unit": "rad"} for x in ("position", "reference")}
    chain = machine(
        motion="rotary", signals=signals, command_law={"kind": "position"}, encoder_resolution=count, mass=None
    )
    run = AxesRun("run", 0.02, {"slide": {"position": count * np.round(out / count), "reference": r}})
    verdict, _ = diagnose_axes(chain, [run], (), lambda _: None)
    found = {c.effect: c for c in verdict.causes}
    expected = {n for n, x in (("drive_lag", lag), ("gravity_load", sag), ("coulomb_friction", stick)) if x}
    timing = {"drive_lag": "drive_lag", "command_delay": "drive_lag"}
    assert {timing.get(e, e) for e in found} >= expected
    if sag:
        assert found["gravity_load"].parameters["force"].value == pytest.approx(sag, rel=0.1)


def test_wrong_mass_and_force_scale_stay_rivals():
    """Without weight or friction both scale with the acceleration alone: the answer is a question."""
    verdict = verdict_of(driven(seconds=12.0), mass=0.8 * MASS)
    named = {verdict.causes[0].effect, *verdict.causes[0].rivals}
    assert verdict.status == "under_excited"
    assert named == {"payload_mass", "torque_constant"}
    assert verdict.next_experiment is not None


def test_a_force_no_effect_makes_is_not_explained():
    rows = driven(seconds=12.0)
    rows[:, 2] += np.sin(2.0 * np.pi * 7.0 * np.arange(len(rows)) * PERIOD)
    verdict = verdict_of(rows)
    assert verdict.status == "outside_library" and "near 7 Hz" in verdict.unexplained.signature


def test_ideal_servo_has_no_gap():
    t = np.arange(0.0, 20.0, 0.02)
    r, count = 0.5 * np.sin(t), 1e-3
    noise = 2e-4 * np.random.default_rng(0).normal(size=len(t))
    signals = {x: {"column": x, "unit": "rad"} for x in ("position", "reference")}
    law = {"kind": "position"}
    chain = machine(motion="rotary", signals=signals, command_law=law, encoder_resolution=count, mass=None)
    run = AxesRun("run", 0.02, {"slide": {"position": count * np.round((r + noise) / count), "reference": r}})
    assert diagnose_axes(chain, [run], (), lambda _: None)[0].status == "no_gap"
