"""One page of speed: every figure, its floor or peer measured in the same run, and the ratio of the two.

Everything runs in turns, three times, and the median is taken, because the speed of a virtual machine changes within
minutes. On a quiet machine it takes ten minutes; `--quick` takes two and is for a look.

    python bench/page.py [--quick] [--seconds 60] [--write docs/reference/speed.md] [--json]
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from typing import Any

import graph
import pauses
from sher3_drivers.bus.load import LOAD_LIMIT, channel_budget
from sher3_drivers.settings import default_settings
from sher3_runtime.environment import child_environment

HERE = Path(__file__).parent
Figures = dict[str, float]
DOMAIN = 75
ROUNDS = 3
BEGIN, END = "<!-- begin: bench -->", "<!-- end: bench -->"
CASE = "schema: sher3.case/1\nrobot: robot.yaml\nruns: []\n"


@dataclass(frozen=True)
class Row:
    """One figure.

    Attributes:
        what: figure and its unit.
        value: measured.
        target: it should be at most this; None without a target.
        peer: figure of the floor or the peer in the same run; None where there is none.
        beside: name of the floor or peer.
    """

    what: str
    value: float
    target: float | None = None
    peer: float | None = None
    beside: str = ""

    def cells(self) -> list[str]:
        """Return the row as text."""
        ratio = f"{self.value / self.peer:.2f}" if self.peer else ""
        kept = (
            "" if self.target is None else f"{self.target:g}" + (" ✓" if self.value <= self.target else " **missed**")
        )
        return [
            self.what,
            f"{self.value:.4g}",
            kept,
            "" if self.peer is None else f"{self.peer:.4g}",
            self.beside,
            ratio,
        ]


def run_json(script: str, *arguments: str, **changes: str) -> dict[str, Any]:
    """Return what another bench prints with `--json`."""
    command = [sys.executable, str(HERE / script), *arguments, "--json"]
    out = subprocess.run(command, env=child_environment(**changes), check=True, capture_output=True, text=True).stdout
    return json.loads(out[out.index("{") :])


def medians(runs: list[Figures]) -> Figures:
    """Return the median of each figure."""
    return {key: median(run[key] for run in runs) for key in runs[0]}


def in_turns(cases: dict[str, Callable[[], Figures]], rounds: int) -> list[Figures]:
    """Return the median figures of each case; in every round each is measured once."""
    found: dict[str, list[Figures]] = {name: [] for name in cases}
    for number in range(rounds):
        for name, measure in cases.items():
            note(f"{name}, round {number + 1} of {rounds}")
            found[name].append(measure())
    return [medians(runs) for runs in found.values()]


def of_graph(rate: float, seconds: float, nodes: str, executor: str = "ours") -> Figures:
    """Return the figures of one run of the graph."""
    return figures_of(graph.measure(rate, seconds, executor, -1, nodes, DOMAIN))


def of_watched_graph(seconds: float) -> Figures:
    """Return the figures of the composed graph at 1 kHz, and how many of its lost cycles no pause explains."""
    with pauses.beside(seconds + 60.0) as found:
        run = graph.measure(1000.0, seconds, "ours", -1, "composed", DOMAIN)
    return {**figures_of(run), "own": pauses.unexplained(run["lost_at"], 1_000_000, found)}


def figures_of(run: dict[str, Any]) -> Figures:
    figures = {key: run["latency"][key] for key in ("p50", "p99", "max")}
    return {**figures, "lost": run["lost_frames"], "cpu": run["cpu_loop"]}


def of_floor(rate: float, seconds: float) -> Figures:
    """Return the figures of one run of the bare processes."""
    found = run_json("floor.py", "--rate", f"{rate:g}", "--seconds", f"{seconds:g}", "--domain", str(DOMAIN + 1))
    return {"p50": found["p50_us"], "p99": found["p99_us"], "max": found["max_us"], "lost": found["lost"],
            "cpu": found["cpu_percent"]}  # fmt: skip


def graph_rows(seconds: float, rounds: int) -> Iterator[Row]:
    """Yield the graph at 1 kHz: composed, separate, floor and rclpy's default executor, in turns."""
    short = min(seconds, 10.0)
    cases: dict[str, Callable[[], Figures]] = {
        "composed at 1 kHz": lambda: of_watched_graph(seconds),
        "floor at 1 kHz": lambda: of_floor(1000.0, seconds),
        "separate at 1 kHz": lambda: of_graph(1000.0, short, "separate"),
        "rclpy at 1 kHz": lambda: of_graph(1000.0, min(short, 6.0), "separate", "default"),
    }
    composed, floor, separate, rclpy = in_turns(cases, rounds)
    targets = {"composed": (150.0, 350.0, 6.0 * seconds / 60.0, 55.0), "separate": (None, None, None, 100.0)}
    for name, case, length in (("composed", composed, seconds), ("separate", separate, short)):
        p50, p99, lost, cpu = targets[name]
        yield Row(f"1 kHz, {name}: force sample to CAN frame, p50 [us]", case["p50"], p50, floor["p50"], "floor")
        yield Row(f"1 kHz, {name}: p99 [us]", case["p99"], p99, floor["p99"], "floor")
        yield Row(f"1 kHz, {name}: longest [us]", case["max"], None, floor["max"], "floor")
        floor_lost = floor["lost"] * length / seconds
        yield Row(f"1 kHz, {name}: lost of {1000 * length:.0f} cycles", case["lost"], lost, floor_lost, "floor")
        if "own" in case:
            what = "of these, its own (no pause of the machine)"
            yield Row(f"1 kHz, {name}: {what}", case["own"])
        yield Row(f"1 kHz, {name}: processor, the loop [% of a core]", case["cpu"], cpu, floor["cpu"], "floor")
    what = "1 kHz, rclpy's default executor, separate"
    yield Row(f"{what}: p50 [us]", rclpy["p50"], None, composed["p50"], "composed")
    yield Row(f"{what}: processor [% of a core]", rclpy["cpu"], None, composed["cpu"], "composed")
    yield Row(f"{what}: lost of {1000 * min(short, 6.0):.0f} cycles", rclpy["lost"])


def other_rates(seconds: float, rounds: int) -> Iterator[Row]:
    """Yield the graph at 500 Hz and 2 kHz beside the floor, in turns, and what a real bus would carry."""
    short, floor_short = min(seconds, 15.0), min(seconds, 8.0)
    cases: dict[str, Callable[[], Figures]] = {
        "composed at 500 Hz": lambda: of_graph(500.0, short, "composed"),
        "floor at 500 Hz": lambda: of_floor(500.0, floor_short),
        "composed at 2 kHz": lambda: of_graph(2000.0, short, "composed"),
        "floor at 2 kHz": lambda: of_floor(2000.0, floor_short),
    }
    slow, floor, fast, fast_floor = in_turns(cases, rounds)
    yield Row("500 Hz, composed: p50 [us]", slow["p50"], None, floor["p50"], "floor")
    yield Row("500 Hz, composed: p99 [us]", slow["p99"], None, floor["p99"], "floor")
    yield Row("500 Hz, composed: processor, the loop [% of a core]", slow["cpu"], 30.0, floor["cpu"], "floor")
    yield Row("2 kHz, composed, no limit of a bus: p50 [us]", fast["p50"], None, fast_floor["p50"], "floor")
    yield Row("2 kHz, composed: p99 [us] of a period of 500 us", fast["p99"], None, fast_floor["p99"], "floor")
    floor_lost = fast_floor["lost"] * short / floor_short
    yield Row(f"2 kHz, composed: lost of {2000 * short:.0f} cycles", fast["lost"], None, floor_lost, "floor")
    yield Row("2 kHz, composed: processor, the loop [% of a core]", fast["cpu"], None, fast_floor["cpu"], "floor")
    bus = channel_budget(1, 2000.0, default_settings(1e-3).heartbeats, protected=True)
    what = f"2 kHz, load of a CAN bus with one protected drive [%]; `sher3 up` refuses more than {100 * LOAD_LIMIT:.0f}"
    yield Row(what, 100.0 * bus.load)


def recorder_rows(seconds: float) -> Iterator[Row]:
    """Yield the recorder of all topics at 1 kHz beside the composed loop."""
    note("recorder at 1 kHz")
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder) / "bag"
        run = graph.measure(1000.0, seconds, "ours", -1, "composed", DOMAIN, str(bag))
        command = [sys.executable, "-m", "sher3_cli", "info", str(bag), "--json"]
        info = json.loads(subprocess.run(command, env=child_environment(), capture_output=True, text=True).stdout)
    topics = info["topics"]
    holes, lost = topics["force/measured_cf"]["dropped"], run["nodes"]["force_sensor"]["lost_cycles"]
    missed = sum(max(0, n - topics[name]["messages"]) for name, n in run["published"].items() if name in topics)
    what = f"in {seconds:.0f} s and the start"
    yield Row("recorder, all topics at 1 kHz [% of a core]", run["cpu_recorder"], 10.0, run["cpu_loop"],
              "the loop it records")  # fmt: skip
    yield Row(f"recorder: samples published and not in the bag, {what}", float(missed), 0.0)
    yield Row("recorder: cycles without a force sample in the bag", float(holes), None, float(lost),
              "cycles the force sensor's node lost")  # fmt: skip


def start_rows(rounds: int) -> Iterator[Row]:
    """Yield the times from a command to its first word."""
    note("starts")
    seconds_to("-m", "sher3_cli", "up", "--duration", "0.2", "--domain", str(DOMAIN), "ready")  # keeps the byte code
    bare = median(seconds_to("-c", "import rclpy; rclpy.init(); rclpy.create_node('a'); print('ready')", "ready")
                  for _ in range(rounds))  # fmt: skip
    up = ("-m", "sher3_cli", "up", "--duration", "0.2", "--domain", str(DOMAIN), "--layout")
    layouts = ("composed", "separate")
    ready = medians([{layout: seconds_to(*up, layout, "ready") for layout in layouts} for _ in range(rounds)])
    for layout, value in ready.items():
        yield Row(f"`sher3 up --layout {layout}` to the ready line [s]", value, 1.5, bare, "one rclpy node")
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "case.yaml").write_text(CASE)
        value = median(seconds_to("-m", "sher3_cli", "gap", "diagnose", folder, "--no-report", "reading the bags")
                       for _ in range(rounds))  # fmt: skip
    numba = median(seconds_to("-c", "import numba; print('ready')", "ready") for _ in range(rounds))
    yield Row("diagnosis, from the command to the first case read [s]", value, 1.5, numba, "import numba")


def seconds_to(*words: str) -> float:
    """Return the time [s] from the start of Python with these arguments to the word that comes last among them.

    Python keeps its byte code, as it does unless it is forbidden to: to compile the project takes 0.25 s.
    """
    *arguments, word = words
    environment = child_environment(PYTHONDONTWRITEBYTECODE="")
    begin = time.perf_counter()
    with subprocess.Popen([sys.executable, *arguments], env=environment, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, cwd=tempfile.gettempdir()) as process:  # fmt: skip
        assert process.stdout is not None
        for line in process.stdout:
            if word in line:
                took = time.perf_counter() - begin
                process.stdout.read()
                return took
    raise SystemExit(f"{' '.join(arguments)} did not say {word!r}")


def computing_rows() -> Iterator[Row]:
    """Yield kinematics, deflection and calibration."""
    note("kinematics and calibration")
    found = run_json("kinematics.py")
    single, batch, pinocchio = found["scalar_us"], found["batch_million_per_s"], "Pinocchio, same tree: frame Jacobian"
    for name, target in (("tip pose", 40.0), ("pose inverse", 40.0), ("tip Jacobian", 70.0)):
        one = found["one_by_one_ns"][name]
        yield Row(f"{name} in batches, one core [ns]", 1e3 / batch[name], target, one, "one by one, compiled")
    for name in ("tip pose", "pose inverse", "tip Jacobian"):
        yield Row(
            f"{name}, a call from Python [us]", single[name], 1.5, single[pinocchio], "Pinocchio's frame Jacobian"
        )
    what = "tip deflection under a wrench"
    yield Row(f"{what} [us]", single[what], 5.0, found["library_us"], "two numpy.linalg.solve")
    arm = run_json("arm.py", "--poses", "3000")
    peer = run_json("arm.py", "--poses", "1500")
    yield Row("calibration of an arm, 3000 poses [s]", arm["clock_s"], 20.0, peer["clock_s"], "1500 poses")


def note(text: str) -> None:
    print(f"  {text}", file=sys.stderr, flush=True)


def table(rows: list[Row]) -> str:
    """Return the page's table in Markdown, with the machine and the date above it."""
    head = ["figure", "measured", "at most", "floor or peer", "which", "ratio"]
    load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
    system = f"{os.uname().sysname} {os.uname().release}"
    lines = [f"{time.strftime('%Y-%m-%d')}, {os.cpu_count()} cores, {system}, load at the end {load}."]
    lines += ["", "| " + " | ".join(head) + " |", "|---|--:|--:|--:|---|--:|"]
    return "\n".join([*lines, *("| " + " | ".join(row.cells()) + " |" for row in rows)])


def write(path: Path, text: str) -> None:
    """Put the table between the marks of a page."""
    before, _, rest = path.read_text().partition(BEGIN)
    path.write_text(f"{before}{BEGIN}\n{text}\n{END}{rest.partition(END)[2]}")


def main() -> None:
    """Measure, print the page, and write it where it is kept."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="one short round")
    parser.add_argument("--seconds", type=float, default=60.0, help="of the composed loop and of the recorder")
    parser.add_argument("--write", type=Path, help="page to keep the table in")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    seconds, rounds = (5.0, 1) if options.quick else (options.seconds, ROUNDS)
    rows = list(graph_rows(seconds, rounds))
    rows += [*other_rates(seconds, rounds), *recorder_rows(seconds), *start_rows(rounds), *computing_rows()]
    text = table(rows)
    if options.write:
        write(options.write, text)
    print(json.dumps([asdict(row) for row in rows]) if options.json else text)
    shutil.rmtree(HERE / "__pycache__", ignore_errors=True)


if __name__ == "__main__":
    main()
