"""Bench: do the intervals of an axis' mass and friction hold the truth, at which rate and noise of its encoder.

Two simulated slides of 8 kg with 6 N of dry and 12 N/(m/s) of viscous friction: one that follows sines and whose mass
is not stated, one that is sent to and fro with stretches of even speed and whose mass is. Their drives run at 1 kHz;
position and force are recorded at 20 to 1000 Hz, with an encoder noise of 1 to 10 counts of 5 um.

    nice python bench/axes_ladder.py                  # seeds 100 to 102: 72 records
    nice python bench/axes_ladder.py --seeds 7:8      # others

Printed are, for each rate and noise, how many of the 95 % intervals hold the truth, and in how many records a friction
was not named or another cause was; then the coverage of each quantity.
"""

from __future__ import annotations

import argparse
from collections import defaultdict

import numpy as np
from sher3_chain.axes.machine import Axes
from sher3_chain.joint.description import AxesDescription
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Verdict

MASS, COULOMB, VISCOUS, COUNT = 8.0, 6.0, 12.0, 5e-6
KP, KD = 2.0e4, 160.0
RATES, NOISES = (20, 100, 500, 1000), (1.0, 3.0, 10.0)
DRIVE, FINE, SECONDS = 1e-3, 5, 30.0
"""Period of the drive, s, steps of the integration in it, and length of a record, s."""
FRICTION = {"coulomb_friction": ("force", COULOMB), "viscous_friction": ("extra", VISCOUS)}
SAME = {"presliding_friction": "coulomb_friction"}
"""An effect that contains another one and gives its number."""


def sines(t: np.ndarray, seed: int) -> np.ndarray:
    """Return the reference of the first slide, m."""
    return 0.08 * np.sin(1.3 * t + seed) + 0.03 * np.sin(4.1 * t + 0.4) + 0.006 * np.sin(9.0 * t)


def strokes(t: np.ndarray, seed: int) -> np.ndarray:
    """Return the reference of the second slide, m: strokes of 0.1 and 0.2 m at speeds of their own."""
    times, places = [0.0], [0.0]
    rng = np.random.default_rng(seed)
    while times[-1] < t[-1] + 2.0:
        times.append(times[-1] + rng.uniform(0.5, 1.2))
        places.append(0.0 if places[-1] else rng.choice([0.1, 0.2]))
    return np.convolve(np.interp(t, times, places), np.ones(200) / 200, "same")  # accelerations of 0.2 s


def record(which: str, rate: int, noise: float, seed: int) -> AxesRun:
    """Simulate a slide under its drive; noise in counts."""
    rng, n, h = np.random.default_rng(seed), int(SECONDS / DRIVE), DRIVE / FINE
    t = DRIVE * np.arange(n)
    reference = sines(t, seed) if which == "sines" else strokes(t, seed)
    error = noise * COUNT * rng.normal(size=n)
    q, v, rows = float(reference[0]), 0.0, np.empty((n, 2))
    for k in range(n):
        read = q + float(error[k])
        u = KP * (float(reference[k]) - q) - KD * v  # the drive has a better encoder than the record
        rows[k] = read, u
        for _ in range(FINE):
            v += h * (u - VISCOUS * v - COULOMB * float(np.tanh(v / 1e-4))) / MASS
            q += h * v
    every = round(1.0 / rate / DRIVE)
    signals = {"position": rows[::every, 0], "effort": rows[::every, 1]}
    return AxesRun(f"{which}{seed}", 1.0 / rate, {"slide": signals})


def described(which: str) -> Axes:
    """Return the slide as a user describes it."""
    axis = {
        "name": "slide",
        "motion": "linear",
        "signals": {"position": {"column": "q", "unit": "m"}, "effort": {"column": "f", "unit": "N"}},
        "command_law": {"kind": "force"},
        "mass": "unknown" if which == "sines" else MASS,
        "encoder_resolution": COUNT,
    }
    time = {"column": "t", "unit": "s"}
    return Axes(AxesDescription.model_validate({"kind": "axes", "name": which, "time": time, "axes": [axis]}))


def held(verdict: Verdict) -> dict[str, bool]:
    """Return for each quantity that has an interval whether it holds the truth."""
    out = {}
    for note in verdict.notes:
        if "mass identified as" in note:
            low, high = (float(x) for x in note.split("(")[1].split(")")[0].split(" .. "))
            out["mass"] = low <= MASS <= high
    for cause in verdict.causes:
        effect = SAME.get(cause.effect, cause.effect)
        if effect in FRICTION:
            name, truth = FRICTION[effect]
            found = cause.parameters[name]
            if found.low is not None and found.high is not None:
                out[effect] = found.low <= truth <= found.high
    return out


def main() -> None:
    """Print the ladder."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="100:103")
    first, last = map(int, parser.parse_args().seeds.split(":"))
    total: dict[str, list[bool]] = defaultdict(list)
    print(f"{'record':8} {'Hz':>5} {'counts':>6}  held     missed, other causes")
    for which in ("sines", "strokes"):
        for rate in RATES:
            for noise in NOISES:
                cell: list[bool] = []
                missed, other = 0, set()
                for seed in range(first, last):
                    verdict = diagnose(described(which), [record(which, rate, noise, seed)]).verdict
                    told = held(verdict)
                    cell += told.values()
                    for name, ok in told.items():
                        total[name].append(ok)
                    named = {SAME.get(c.effect, c.effect) for c in verdict.causes}
                    missed += len(FRICTION.keys() - named)
                    other |= named - FRICTION.keys()
                print(
                    f"{which:8} {rate:5d} {noise:6.0f}  {sum(cell):2d}/{len(cell):<3d}    {missed} {' '.join(other)}",
                    flush=True,
                )
    for name, all_of in total.items():
        print(f"{name}: {sum(all_of)} of {len(all_of)} = {np.mean(all_of):.3f}")


if __name__ == "__main__":
    main()
