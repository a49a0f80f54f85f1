"""What the live view costs the graph: processor time of the robot's processes with and without it, and the view's own.

Starts the robot on mocks in turn alone and with `sher3 view` beside it, and, where there is a Chromium, with a headless
browser that shows the page. Processor time in percent of one core, of all processes of `sher3 up`; the spread over the
rounds tells what a difference is worth. Processor time is little moved by other work on the computer.

    python bench/view.py                      # 4 rounds of 10 s each way
    python bench/view.py --rounds 2 --seconds 5 --json
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import psutil

DOMAIN = 75
PORT = 18975
SETTLE = 4.0
"""Seconds after the start that are not counted."""
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
FLAGS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")


def main() -> None:
    """Run the rounds and print them, or one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    rows = [(measure(options.seconds, False), measure(options.seconds, True)) for _ in range(options.rounds)]
    alone, seen = [row[0]["graph"] for row in rows], [row[1]["graph"] for row in rows]
    result = {
        "graph_alone": alone,
        "graph_with_view": seen,
        "view": [row[1]["view"] for row in rows],
        "browser": CHROMIUM is not None,
        "load": os.getloadavg(),
    }
    if options.json:
        print(json.dumps(result))
        return
    print(f"graph alone      {_spread(alone)} % of a core")
    print(f"graph with view  {_spread(seen)} % of a core")
    print(f"the view itself  {_spread(result['view'])} % of a core, browser {'open' if CHROMIUM else 'not there'}")


def measure(seconds: float, view: bool) -> dict[str, float]:
    """Return the processor time of graph and view [% of a core] over so many seconds."""
    with ExitStack() as stack:
        graph = stack.enter_context(_running("ready", "up", "--patient", "--domain", str(DOMAIN)))
        words = ("live on", "view", "--domain", str(DOMAIN), "--port", str(PORT))
        page = stack.enter_context(_running(*words)) if view else None
        time.sleep(SETTLE)
        if view and CHROMIUM:
            profile = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
            command = [CHROMIUM, *FLAGS, f"--user-data-dir={profile}", "--remote-debugging-port=0"]
            stack.enter_context(_process([*command, f"http://127.0.0.1:{PORT}"]))
            time.sleep(SETTLE)
        processes = {"graph": graph, "view": page}
        before = {name: _processor_time(p) for name, p in processes.items()}
        begin = time.monotonic()
        time.sleep(seconds)
        took = time.monotonic() - begin
        return {name: 100.0 * (_processor_time(p) - before[name]) / took for name, p in processes.items()}


@contextmanager
def _running(ready: str, *words: str) -> Iterator[subprocess.Popen]:
    """Run a command of `sher3`; begin when it has said so."""
    with _process([sys.executable, "-m", "sher3_cli", *words], subprocess.PIPE) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if ready in line:
                break
        yield process
        if process.poll() is not None:
            raise SystemExit(f"{words[0]} ended before the measurement was over")


@contextmanager
def _process(command: list[str], output: int = subprocess.DEVNULL) -> Iterator[subprocess.Popen]:
    process = subprocess.Popen(command, stdout=output, stderr=subprocess.DEVNULL, text=True)
    try:
        yield process
    finally:
        process.terminate()
        process.wait(30.0)


def _processor_time(process: subprocess.Popen | None) -> float:
    """Return the processor time [s] of a process and its children so far."""
    if process is None:
        return 0.0
    root = psutil.Process(process.pid)
    return sum(sum(p.cpu_times()[:2]) for p in (root, *root.children(recursive=True)))


def _spread(values: list[float]) -> str:
    low, high = min(values), max(values)
    return f"{statistics.fmean(values):6.1f} ({low:.1f} to {high:.1f})"


if __name__ == "__main__":
    main()
