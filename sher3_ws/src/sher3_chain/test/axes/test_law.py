"""The recorded command against the stated law: each fault of a controller is told."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import KD, KP, MASS, PERIOD, effects, machine

COUNT = 1e-6


def controlled(law, seed=3, seconds=12.0, smooth=False):
    """Rows of a slide with 8 N of dry and 30 N/(m/s) of viscous friction whose controller asks `law` for its force.

    Args:
        law: takes the errors and the speeds that were read up to now; returns the command, N.
        seed: of the phases of the reference.
        seconds: length.
        smooth: whether the controller smooths its speed.
    """
    t, (a, b) = np.arange(0.0, seconds, PERIOD), np.random.default_rng(seed).uniform(0.0, 6.0, 2)
    reference = 0.04 * np.sin(1.3 * t + a) + 0.015 * np.sin(4.1 * t + b)
    reference = reference.tolist()
    x, v, last = reference[0], (reference[1] - reference[0]) / PERIOD, reference[0]
    errors, speeds, rows = [], [], np.empty((len(t), 3))
    for k in range(len(t)):
        read = COUNT * round(x / COUNT)
        pace = (read - last) / PERIOD
        errors.append(reference[k] - read)
        speeds.append(0.7 * speeds[-1] + 0.3 * pace if smooth and speeds else pace)
        u = float(law(np.array(errors[-40:]), np.array(speeds[-40:])))
        rows[k], last = (read, reference[k], u), read
        for _ in range(20):
            v += PERIOD / 20.0 * (u - 8.0 * float(np.tanh(v / 2e-4)) - 30.0 * v) / MASS
            x += PERIOD / 20.0 * v
    return rows


def verdict_of(rows, period=PERIOD, **law):
    stated = {"kind": "force", "position_gain": KP, "velocity_gain": KD, "held": True, **law}
    signals = dict(zip(("position", "reference", "command"), rows.T, strict=True))
    return diagnose(machine(command_law=stated), [AxesRun("run", period, {"slide": signals})]).verdict


def of_controller(verdict):
    return {c.effect: c for c in verdict.causes if c.stage == "controller"}


def as_stated(e, v):
    return KP * e[-1] - KD * v[-1]


@pytest.mark.parametrize("smooth", [False, True])
def test_a_command_that_is_what_was_stated(smooth):
    """However the controller takes its speed: nobody states that."""
    verdict = verdict_of(controlled(as_stated, smooth=smooth))
    assert not of_controller(verdict)
    if not smooth:
        assert any("what the stated law asks for" in n for n in verdict.notes)
    assert {"coulomb_friction", "viscous_friction"} <= set(effects(verdict))


@pytest.mark.parametrize("rows", [2, 3, 10])
def test_a_log_that_is_slower_than_its_controller(rows):
    """Over a shorter time than the log tells, a speed is late by less: that is no term that nobody stated."""
    verdict = verdict_of(controlled(as_stated)[::rows], PERIOD * rows)
    assert not of_controller(verdict) and {p.stage for p in verdict.places} == {"motor_mechanics"}
    assert {"coulomb_friction", "viscous_friction"} <= set(effects(verdict))


@pytest.mark.parametrize("rows", [2, 3, 4, 5])
def test_a_slower_log_of_a_speed_over_two_periods(rows):
    """A controller that takes its speed over two of its periods is late by one: 1/2, 1/3, ... of the log's period."""

    def calm(e, v):
        return KP * e[-1] - KD * 0.5 * (v[-1] + v[-2] if len(v) > 1 else v[-1])

    assert not of_controller(verdict_of(controlled(calm)[::rows], rows * PERIOD, held=False))


@pytest.mark.parametrize("share", [0.8, 0.95, 1.3])
def test_another_gain(share):
    verdict = verdict_of(controlled(lambda e, v: share * as_stated(e, v)))
    found = of_controller(verdict)
    assert set(found) == {"controller_gain"}
    assert found["controller_gain"].parameters["relative"].value == pytest.approx(share - 1.0, abs=0.005)
    assert {"coulomb_friction", "viscous_friction"} <= set(effects(verdict))


def test_another_gain_of_one_part():
    found = of_controller(verdict_of(controlled(lambda e, v: 0.8 * KP * e[-1] - KD * v[-1])))
    assert set(found) == {"controller_gain"}
    assert found["controller_gain"].parameters["position_relative"].value == pytest.approx(-0.2, abs=0.01)


def test_a_late_command():
    """Three periods, 6 ms."""
    found = of_controller(verdict_of(controlled(lambda e, v: as_stated(e[:-3], v[:-3]) if len(e) > 3 else 0.0)))
    assert set(found) == {"command_delay"}
    assert found["command_delay"].parameters["delay"].value == pytest.approx(3.0 * PERIOD, abs=PERIOD)


@pytest.mark.parametrize("soft", [False, True])
def test_a_dead_zone(soft):
    """0.1 mm, within which the error is not answered."""

    def law(e, v):
        seen = e[-1] - np.clip(e[-1], -1e-4, 1e-4) if soft else e[-1] * (abs(e[-1]) > 1e-4)
        return KP * seen - KD * v[-1]

    found = of_controller(verdict_of(controlled(law)))
    assert set(found) == {"command_deadband"}
    assert found["command_deadband"].parameters["width"].value == pytest.approx(1e-4, rel=0.06)


def test_a_limit_that_nobody_stated():
    found = of_controller(verdict_of(controlled(lambda e, v: np.clip(as_stated(e, v), -9.0, 9.0))))
    assert "command_limit" in found
    assert found["command_limit"].parameters["limit"].value == pytest.approx(9.0, rel=0.02)


@pytest.mark.parametrize(
    ("name", "size"), [("constant", 4.0), ("speed_gain", 60.0), ("acceleration_gain", 6.0), ("integral_gain", 2.0e5)]
)
def test_a_term_that_nobody_stated(name, size):
    rng = np.random.default_rng(3)
    a, b = rng.uniform(0.0, 6.0, 2)
    total = [0.0, 0]

    def law(e, v):
        total[0] += e[-1] * PERIOD
        t, total[1] = total[1] * PERIOD, total[1] + 1
        speed = 0.052 * np.cos(1.3 * t + a) + 0.0615 * np.cos(4.1 * t + b)
        bend = -0.0676 * np.sin(1.3 * t + a) - 0.25215 * np.sin(4.1 * t + b)
        term = {"constant": 1.0, "speed_gain": speed, "acceleration_gain": bend, "integral_gain": total[0]}
        return as_stated(e, v) + size * term[name]

    found = of_controller(verdict_of(controlled(law)))
    assert set(found) == {"unstated_term"}
    assert found["unstated_term"].parameters[name].value == pytest.approx(size, rel=0.05)


def test_an_integral_that_was_stated():
    """Nobody knows where it began: a constant beside it is no gap."""
    total = [3e-5]

    def law(e, v):
        total[0] += e[-1] * PERIOD
        return as_stated(e, v) + 2e5 * total[0]

    assert not of_controller(verdict_of(controlled(law), integral_gain=2e5))
