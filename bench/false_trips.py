"""How near healthy robots come to the limits of the motor driver's watches, and which imperfect ones they stop.

    python bench/false_trips.py [--seeds N] [--json]

Simulates every standard excitation with run-to-run scatter and noise, several seeds each, and hands every tick's
feedback to the checks of encoders, following, obedience and frozen reports with their strict limits. Then once with
each effect of the library in its default size.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections import Counter
from typing import Any

import numpy as np
from sher3_description import load_robot
from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.canopen.tpdo import DriveFeedback
from sher3_drivers.settings import default_settings
from sher3_drivers.units import AxisScale
from sher3_drivers.watches.motion import MotionWatch
from sher3_drivers.watches.trips import StopLog, Trip
from sher3_effects import plants
from sher3_gap.excitation import catalogue, excite
from sher3_safety.measurement.report import false_trips
from sher3_sim import simulate
from sher3_sim.scatter import RunScatter

ROBOT = load_robot()
SETTINGS = default_settings(ROBOT.control_period)
SCALES = [AxisScale.from_actuator(actuator) for actuator in ROBOT.actuators]
LABELS = list(catalogue())
SHARES = ("encoders", "following", "position")


def watch(run: Any) -> tuple[Trip | None, dict[str, float]]:
    """Hand a run to the watches; return the first trip and the largest share of each limit."""
    columns = [run[topic] for topic in ("measured_js", "drives/measured_js", "drives/setpoint_jv", "servo_jv")]
    load, motor, velocity = columns[0].position, columns[1].position, columns[1].velocity
    effort, echo, command = columns[1].effort, columns[2].velocity, columns[3].velocity
    checks, log, shares = MotionWatch(SCALES, SETTINGS), StopLog(), dict.fromkeys(SHARES, 0.0)
    checks.begin()
    for k in range(len(load)):
        rows = (tuple(column[k].tolist()) for column in (load, motor, velocity, effort, echo))
        stamp = round(k * SETTINGS.period * 1e9)
        checks.sync()
        trip = checks.check(DriveFeedback(stamp, *rows), Goal.ENABLED, True, log, stamp)
        if trip is not None:
            return trip, shares
        for axis in checks.joints.axes:
            shares["encoders"] = max(shares["encoders"], abs(axis["gap"]) / axis.limit)
            shares["following"] = max(shares["following"], abs(axis["error"]) / axis["error_limit"])
        together = math.hypot(*(place.departure / place.limit for place in checks.position.axes))
        shares["position"] = max(shares["position"], together)
        checks.demand.sent([round(v / s.velocity) for v, s in zip(command[k].tolist(), SCALES, strict=True)])
    return None, shares


def play(label: str, seed: int, effects: tuple[Any, ...] = ()) -> Any:
    """Return a simulated run of a standard excitation."""
    made = excite(label, ROBOT)
    wrench = made.contact_wrench()
    return simulate(ROBOT, made.position, wrench, effects, seed, setpoint_velocity=made.velocity, scatter=RunScatter())


def healthy(seeds: int) -> dict[str, Any]:
    """Return trips and margins of healthy robots."""
    ticks, trips, shares = 0, Counter[str](), dict.fromkeys(SHARES, 0.0)
    for label in LABELS:
        for seed in range(seeds):
            run = play(label, seed)
            ticks += len(run["measured_js"].stamp)
            trip, found = watch(run)
            if trip is not None:
                trips[f"{trip.reason.name} in {label}: {trip.text}"] += 1
            shares = {name: max(shares[name], found[name]) for name in shares}
    minutes = ticks * ROBOT.control_period / 60.0
    bound = false_trips(sum(trips.values()), minutes / 60.0)["upper_95"]
    return {"minutes": minutes, "trips": dict(trips), "per_hour_upper_95": bound, "largest_share_of_limit": shares}


def cost() -> float:
    """Return the processor time of one tick of all watches [us], the least of five runs."""
    run, times = play("sweep", 0), []
    for _ in range(5):
        start = time.thread_time()
        watch(run)
        times.append(time.thread_time() - start)
    return 1e6 * min(times) / len(run["measured_js"].stamp)


def imperfect() -> dict[str, str]:
    """Return per effect that stops the robot in its default size, on the axis with the first place, why."""
    found = {}
    for name, kind in plants().items():
        trip, _ = watch(play("sweep", 1, (kind(kind.sites[0]),)))
        if trip is not None:
            found[name] = f"{trip.reason.name}: {trip.text}"
    return found


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    result = {"healthy": healthy(options.seeds), "stopped_effects": imperfect(), "effects": len(plants()), "us": cost()}
    if options.json:
        print(json.dumps(result))
        return
    good = result["healthy"]
    rate = f"{sum(good['trips'].values())} trips, at most {good['per_hour_upper_95']:.1f} per hour (95 %)"
    print(f"healthy: {good['minutes']:.1f} min of {len(LABELS)} excitations, {rate}")
    for name, share in good["largest_share_of_limit"].items():
        print(f"  largest share of the limit of {name}: {100.0 * share:.0f} %")
    for text, count in good["trips"].items():
        print(f"  {count} x {text}")
    print(f"effects of default size that stop the robot: {len(result['stopped_effects'])} of {result['effects']}")
    for name, text in result["stopped_effects"].items():
        print(f"  {name}: {text}")
    print(f"cost of all watches and of this loop: {result['us']:.0f} us a tick")


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main()
