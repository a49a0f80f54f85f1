"""How fast the plant runs on one core, and how fine its integration has to be.

    python bench/plant.py [--seconds S] [--json]

Prints multiples of real time (processor time) of whole closed-loop runs, nominal and with more and more effects,
the time of one live step, and the error of the default integration step against one sixteen times finer, per effect.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable

import numpy as np
from sher3_description import load_robot
from sher3_effects import plants
from sher3_sim import Excitation, Plant, excitation, simulate, simulate_arrays, with_effects

ROBOT = load_robot()
PERIOD = ROBOT.control_period


def drive(seconds: float) -> Excitation:
    """Return smooth motion of all axes with reversals, and contact."""
    t = np.arange(round(seconds / PERIOD)) * PERIOD
    wave = 1.5e-3 * np.sin(2 * np.pi * 0.7 * t) + 2e-4 * np.sin(2 * np.pi * 5 * t)
    wrench = np.zeros((len(t), 6))
    wrench[len(t) // 3 : len(t) // 2, :3] = 0.6, -0.5, 0.4
    return excitation(np.outer(wave, [1.0, -0.8, 0.6, 40.0, 0.9]), None, wrench, 25.0, period=PERIOD)


def best(call: Callable[[], object], repeats: int = 7) -> float:
    """Return the shortest processor time of several calls [s]; other processes on the core do not count."""
    times = []
    for _ in range(repeats):
        start = time.thread_time()
        call()
        times.append(time.thread_time() - start)
    return min(times)


def speeds(seconds: float) -> list[dict]:
    """Return run time by number of effects."""
    motion = drive(seconds)
    every = [kind(kind.sites[0]) for kind in plants().values()]
    rows = []
    for count in (0, 1, 2, 4, 8, 16, len(every)):
        plant = with_effects(ROBOT, every[:count])
        spent = best(lambda plant=plant: simulate_arrays(plant, motion))
        rows.append({"effects": count, "seconds": spent, "times_real_time": seconds / spent})
    return rows


def convergence() -> list[dict]:
    """Return per effect the rms error of the default step, in encoder counts and in effort noise."""
    motion = drive(4.0)
    counts = np.array([a.motor_encoder for a in ROBOT.actuators])
    noise = np.array([0.002 * a.drive.rated for a in ROBOT.actuators])
    rows = []
    for kind in plants().values():
        places = [a for a in kind.sites if a in ("delta_1", "roll", "tilt")] or [kind.sites[0]]
        plant = with_effects(ROBOT, [kind(place) for place in places]).without_noise()
        coarse = simulate_arrays(plant, motion)[1]
        plant.substeps *= 16
        fine = simulate_arrays(plant, motion)[1]
        motor = np.sqrt(np.mean(((coarse["motor"] - fine["motor"]) / counts) ** 2, axis=0)).max()
        effort = np.sqrt(np.mean(((coarse["effort"] - fine["effort"]) / noise) ** 2, axis=0)).max()
        rows.append({"effect": kind.id, "motor_counts": float(motor), "effort_noise": float(effort)})
    return rows


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10.0, help="simulated length of a run")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    motion = drive(arguments.seconds)
    begin = time.perf_counter()
    simulate(ROBOT, motion.position, motion.wrench)
    first = time.perf_counter() - begin
    plant, rest = Plant(ROBOT), np.zeros(5)
    result = {
        "first_call_seconds": first,
        "live_step_microseconds": 1e6 * best(lambda: [plant.step(rest) for _ in range(1000)]) / 1000,
        "run_with_streams_seconds": best(lambda: simulate(ROBOT, motion.position, motion.wrench)),
        "runs": speeds(arguments.seconds),
        "convergence": convergence(),
    }
    if arguments.json:
        print(json.dumps(result, indent=1))
        return
    print(f"first call with loading or compiling     {first:8.2f} s")
    print(f"live step                                {result['live_step_microseconds']:8.1f} us")
    print(
        f"run of {arguments.seconds:g} s with all streams           {1e3 * result['run_with_streams_seconds']:8.1f} ms"
    )
    print("effects   ms per run   x real time")
    for row in result["runs"]:
        print(f"{row['effects']:7d} {1e3 * row['seconds']:12.2f} {row['times_real_time']:13.0f}")
    print("largest integration errors             motor [counts]   effort [noise sd]")
    for row in sorted(result["convergence"], key=lambda row: -row["motor_counts"])[:6]:
        print(f"  {row['effect']:36} {row['motor_counts']:14.4f} {row['effort_noise']:19.4f}")


if __name__ == "__main__":
    main()
