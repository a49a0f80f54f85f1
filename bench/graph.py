"""Speed of the whole graph: force sample to CAN frame, jitter, lost cycles and processor time, at 200, 500 and 1000 Hz.

Starts the real graph on mocks in its own processes with a surgeon who pushes, traces every sample at both ends of the
chain, and joins the ends by stamp. The default executor is rclpy's own with message objects and the same nodes; by
default both are run. Figures in microseconds; processor time in percent of one core: the control loop (force sensor,
pedal, admittance, kinematics, motor driver, plant), the supervisor beside it, and the load of the bench (the surgeon).
Time limits are those of `--patience patient`, so that a pause of the machine shows as lost cycles and not as a stop.

    python bench/graph.py                      # 200, 500, 1000 Hz, ours beside the default, 10 s each
    python bench/graph.py --rate 1000 --seconds 60 --only ours --json
    python bench/graph.py --only ours --layout composed
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np

DOMAIN = 74
SETTLE = 3.0
"""Seconds after the start that are not counted."""
EXECUTORS = {"ours": "", "default": "default"}


def main() -> None:
    """Run the cases and print a table, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rate", type=float, nargs="+", default=[200.0, 500.0, 1000.0])
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--only", choices=EXECUTORS)
    parser.add_argument("--realtime", type=int, default=-1, help="SCHED_FIFO priority, -1 where permitted, 0 never")
    parser.add_argument("--nodes", help="nodes of each process as in `sher3 up --nodes`, instead of a layout")
    parser.add_argument("--layout", choices=("separate", "composed"), default="separate")
    parser.add_argument("--domain", type=int, default=DOMAIN)
    parser.add_argument("--baseline-seconds", type=float, help="length of the runs on the default executor")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    results = []
    for rate in options.rate:
        for executor in [options.only] if options.only else EXECUTORS:
            seconds = options.baseline_seconds if executor == "default" else None
            nodes = options.nodes or options.layout
            result = measure(rate, seconds or options.seconds, executor, options.realtime, nodes, options.domain)
            results.append(result)
            if not options.json:
                print(text(result), flush=True)
    if options.json:
        print(json.dumps({"load": os.getloadavg(), "cores": os.cpu_count(), "results": results}))
    elif not options.only:
        for ours, default in zip(results[::2], results[1::2], strict=True):
            ratio = default["latency"]["p50"] / ours["latency"]["p50"]
            less = default["cpu_loop"] / ours["cpu_loop"]
            print(f"{ours['rate']:6.0f} Hz: default {ratio:.1f} times as long in p50, {less:.1f} times the CPU")


def measure(
    rate: float,
    seconds: float,
    executor: str = "ours",
    realtime: int = -1,
    nodes: str = "separate",
    domain: int = DOMAIN,
    record: str = "",
) -> dict[str, Any]:
    """Run the graph in a process of its own, which reports the processor time of each node, and read the traces.

    Args:
        rate: of control [Hz].
        seconds: counted.
        executor: one of `EXECUTORS`.
        realtime: SCHED_FIFO priority, as in `sher3 up`.
        nodes: a layout, or the nodes of each process as in `sher3 up --nodes`.
        domain: ROS domain id.
        record: folder of a recording; none by default.
    """
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, __file__.replace("graph.py", "graph_run.py")]
        arguments = [str(rate), str(seconds + SETTLE), str(SETTLE), str(realtime), str(domain), nodes, record]
        from sher3_runtime.environment import child_environment

        environment = child_environment(SHER3_TRACE=folder, SHER3_EXECUTOR=EXECUTORS[executor])
        run = subprocess.run([*command, *arguments], env=environment, capture_output=True, text=True, check=False)
        if run.returncode:
            sys.exit(f"the graph at {rate:g} Hz on the {executor} executor failed:\n{run.stderr}")
        cpu = json.loads(run.stdout.splitlines()[-1])
        return {"rate": rate, "executor": executor, "seconds": seconds, **evaluate(Path(folder), rate, seconds), **cpu}


def evaluate(folder: Path, rate: float, seconds: float) -> dict[str, Any]:
    """Return latencies, jitter and losses from the traces."""
    nodes = {path.stem: json.loads(path.read_text()) for path in folder.glob("*.json")}
    sent = trace(nodes["force_sensor"], "publish force/measured_cf")
    frames = trace(nodes["motor_driver"], "sent servo_jv")
    first = min(sent) + round(SETTLE * 1e9)
    window = [stamp for stamp in sent if first <= stamp < first + round(seconds * 1e9)]
    enabled = bool(frames) and window[-1] - max(frames) < 1e9
    # Drives that a late loop never got enabled: the driver has refused the command by then, but it has had it.
    done = frames if enabled else trace(nodes["motor_driver"], "handled servo_jv")
    latency = np.array([done[stamp] - sent[stamp] for stamp in window if stamp in done]) / 1e3
    starts = np.array([sent[stamp] for stamp in sorted(window)])
    period = np.abs(np.diff(starts) / 1e3 - 1e6 / rate)
    grid = round(seconds * rate)
    due = (first + round(number * 1e9 / rate) for number in range(grid))
    return {
        "latency": spread(latency),
        "jitter": spread(period),
        "cycles": grid,
        "lost_samples": grid - len(window),
        "lost_frames": grid - len(latency),
        "lost_at": [stamp for stamp in due if stamp not in sent or stamp not in done],
        "enabled": enabled,
        "published": published(nodes),
        "nodes": {name: node["statistics"] for name, node in sorted(nodes.items())},
    }


def published(nodes: dict[str, Any]) -> dict[str, int]:
    """Return how many samples were published on each topic with stamps, from the first tick to the last."""
    points = {point: len(data["stamps"]) for node in nodes.values() for point, data in node["traces"].items()}
    return {point.removeprefix("publish "): count for point, count in points.items() if point.startswith("publish ")}


def trace(node: dict[str, Any], point: str) -> dict[int, int]:
    """Return time by stamp at a point of the chain; the first passage counts."""
    data = node["traces"].get(point) or {"stamps": [], "times": []}
    return dict(zip(reversed(data["stamps"]), reversed(data["times"]), strict=True))


def spread(values: np.ndarray) -> dict[str, float]:
    """Return p50, p99, p99.9 and maximum."""
    if not len(values):
        return dict.fromkeys(("p50", "p99", "p99.9", "max"), float("nan"))
    p50, p99, p999, most = np.percentile(values, [50, 99, 99.9, 100])
    return {"p50": float(p50), "p99": float(p99), "p99.9": float(p999), "max": float(most)}


def text(result: dict[str, Any]) -> str:
    """Return a result in a few lines."""
    latency, jitter = result["latency"], result["jitter"]
    cpu = " ".join(f"{name} {share:.1f}" for name, share in result["cpu"].items())
    return (
        f"{result['rate']:6.0f} Hz {result['executor']:8} force -> CAN frame p50 {latency['p50']:.0f} p99 "
        f"{latency['p99']:.0f} max {latency['max']:.0f} us; jitter p50 {jitter['p50']:.0f} p99 {jitter['p99']:.0f} us; "
        f"{'' if result['enabled'] else 'ROBOT NOT ENABLED, commands refused; '}lost {result['lost_frames']} of "
        f"{result['cycles']} cycles; CPU of the loop {result['cpu_loop']:.0f}, "
        f"supervisor {result['cpu_supervisor']:.0f}, bench {result['cpu_bench']:.0f} % of a core ({cpu})"
    )


if __name__ == "__main__":
    begin = time.monotonic()
    main()
