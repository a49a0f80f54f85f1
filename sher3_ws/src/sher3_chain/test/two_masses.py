"""A motor and its load behind a gap with stiff flanks, or on a spring: simulated for the tests by contact forces."""

import numpy as np
from sher3_chain.joint.record import AxesRun
from sher3_common.compiled import compiled
from sher3_diagnosis import diagnose
from slides import machine

PERIOD, COUNT = 0.002, 1e-6
"""Period (s) and encoder count (m)."""
STIFF, DAMPED = 3.0e6, 600.0
"""Flanks, N/m and N/(m/s)."""


@compiled
def moved(reference, motor, load, contact, noise, fine):
    """Reading and command (n, 2) of a motor under a PD law; its load hangs on it by a contact force.

    Args:
        reference: (n,) m.
        motor: mass, dry and viscous friction.
        load: mass and dry friction.
        contact: gap, stiffness and damping of its flanks.
        noise: of the encoder, (n,) m.
        fine: steps a period.
    """
    out = np.empty((len(reference), 2))
    h = 0.002 / fine
    x, v = reference[0], (reference[1] - reference[0]) / 0.002
    y, w, last = x, v, x
    for k in range(len(reference)):
        read = 1e-6 * np.round((x + noise[k]) / 1e-6)
        force = 4e4 * (reference[k] - read) - 1.2e3 * (read - last) / 0.002
        out[k, 0], out[k, 1], last = read, force, read
        for _ in range(fine):
            apart, push = x - y, 0.0
            if abs(apart) >= 0.5 * contact[0]:
                side = 1.0 if apart > 0.0 else -1.0
                push = contact[1] * (apart - 0.5 * side * contact[0]) + contact[2] * (v - w)
                if contact[0] > 0.0 and push * side < 0.0:
                    push = 0.0
            v += h * (force - push - motor[1] * np.tanh(v / 2e-4) - motor[2] * v) / motor[0]
            w += h * (push - load[1] * np.tanh(w / 2e-4)) / load[0]
            x += h * v
            y += h * w
    return out


@compiled
def stuck(reference, mass, friction, reach, noise, fine):
    """Reading and command (n, 2) of one mass under the same law; its friction builds up over `reach`, m (Dahl)."""
    out = np.empty((len(reference), 2))
    h = 0.002 / fine
    x, v = reference[0], (reference[1] - reference[0]) / 0.002
    bent, last = 0.0, x
    for k in range(len(reference)):
        read = 1e-6 * np.round((x + noise[k]) / 1e-6)
        force = 4e4 * (reference[k] - read) - 1.2e3 * (read - last) / 0.002
        out[k, 0], out[k, 1], last = read, force, read
        for _ in range(fine):
            bent = min(max(bent + h * (v - abs(v) * bent / reach), -reach), reach)
            v += h * (force - friction * bent / reach - 20.0 * v) / mass
            x += h * v
    return out


def sines(seed, seconds=16.0):
    """A reference of three sines with phases of the seed, up to 0.8 m/s^2."""
    t, phase = np.arange(0.0, seconds, PERIOD), np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, 3)
    parts = zip((0.04, 0.015, 0.004), (1.3, 4.1, 11.0), phase, strict=True)
    return sum(size * np.sin(pace * t + start) for size, pace, start in parts)


def sweep(seed, seconds=16.0):
    """A slow stroke and a sweep from 1 to 20 Hz."""
    t = np.arange(0.0, seconds, PERIOD)
    start = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi)
    return 0.04 * np.sin(1.3 * t + start) + 0.002 * np.sin(2.0 * np.pi * (1.0 + 0.6 * t) * t)


def behind_gap(gap, seed=3, motor=(6.0, 4.0, 20.0), load=(6.0, 6.0), noise=0.0):
    """Rows of a load behind a gap, m."""
    reference = sines(seed)
    white = noise * np.random.default_rng(seed).normal(size=len(reference))
    return reference, moved(reference, motor, load, (gap, STIFF, DAMPED), white, 200)


def slowly_stuck(reach, seed=3, mass=12.0, friction=10.0, noise=0.0):
    """Rows of a rigid mass whose friction builds up over `reach`, m."""
    reference = sines(seed)
    white = noise * np.random.default_rng(seed).normal(size=len(reference))
    return reference, stuck(reference, mass, friction, reach, white, 200)


def on_spring(frequency, seed=3, motor=(8.0, 4.0, 20.0), load=(4.0, 1.0), damping=0.05):
    """Rows of a load on a spring, whose frequency (Hz) is that of the load while the motor is held."""
    reference, pace = sweep(seed), 2.0 * np.pi * frequency
    contact = (0.0, load[0] * pace**2, 2.0 * damping * load[0] * pace)
    return reference, moved(reference, motor, load, contact, np.zeros(len(reference)), 200)


def verdict_of(rows, mass=12.0):
    """Verdict of the rows of a driven axis with one encoder, at the motor."""
    reference, (position, command) = rows[0], rows[1].T
    run = AxesRun("run", PERIOD, {"slide": {"position": position, "reference": reference, "command": command}})
    arm = machine(command_law={"kind": "force", "held": True}, mass=mass, encoder_resolution=COUNT)
    return diagnose(arm, [run]).verdict
