"""Soak of the whole graph on mocks: what grows, gets lost or stays behind.

Every node in its own process, a surgeon who pushes to and fro, a recorder. Once a second resident memory, file
descriptors and threads of every process are noted; at the end the nodes' own histograms are read, the bag is read back,
and /dev/shm, sockets and processes are looked through for leftovers.

    python bench/soak.py --seconds 600            # the nightly form
    python bench/soak.py --seconds 30 --json

Exit code 1 when memory, descriptors or threads grow, a message was invalid, something is left behind, or the robot did
not stay ENABLED and moving (`--any-state` leaves the last out, and memory where the recording lost samples, for
machines busy with other things). Memory grows when,
in the second half of the run, the slope's 95 % interval lies above `GROWTH_LIMIT` and memory rises by more than
`RISE_LIMIT`: queues fill to their depth at the first hold-up and stay there, a leak goes on; and over seconds a single
page allocated is megabytes an hour.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import shutil
import socket
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import psutil
from scipy import stats
from sher3_common.operating_state import OperatingState

DOMAIN = 75
SETTLE = 4.0
"""Seconds after the start whose memory does not count: first histograms, first chunks, lazy imports."""
GROWTH_LIMIT = 20.0
"""MB per hour."""
RISE_LIMIT = 2.0
"""MB."""
BLOCKS = 20
"""The slope is that of so many means, whose errors are nearly independent; those of samples a second apart are not."""
SCRIPT = """
schema: sher3.teleop/1
steps:
  - {name: settle, duration: 1.0}
  - {name: enable, duration: 0.5, command: enable}
  - {name: push, duration: 3600, pedal: 1.0, dither: [1.0, 0.8, 0.5, 0, 0, 0], frequency: 0.5}
"""


@dataclass
class Samples:
    """What a process held, once a second: seconds, resident memory [MB], file descriptors, threads."""

    time: list[float] = field(default_factory=list)
    rss: list[float] = field(default_factory=list)
    files: list[int] = field(default_factory=list)
    threads: list[int] = field(default_factory=list)

    def look(self, process: psutil.Process, elapsed: float) -> None:
        """Note the present state; a process that is just ending is left out."""
        with contextlib.suppress(psutil.Error):
            with process.oneshot():
                row = process.memory_info().rss / 1e6, process.num_fds(), process.num_threads()
            self.time.append(elapsed)
            self.rss.append(row[0])
            self.files.append(row[1])
            self.threads.append(row[2])

    def verdict(self) -> dict[str, Any]:
        """Return slope [MB/h] with its 95 % interval, rise [MB], first and last counts, and whether anything grew."""
        half, fifth = len(self.rss) // 2, max(1, len(self.rss) // 5)
        late = np.array(self.rss[half:])
        slope, low, high = growth(np.array(self.time[half:]), late)
        end = max(1, len(late) // 5)
        rise = float(late[-end:].mean() - late[:end].mean())
        files, threads = self.files[-1] - max(self.files[:fifth]), self.threads[-1] - max(self.threads[:fifth])
        return {
            "rss_mb": self.rss[-1],
            "slope_mb_per_hour": [slope, low, high],
            "rise_mb": rise,
            "rss_mb_by_tenth": [
                round(float(part.mean()), 2) for part in np.array_split(np.array(self.rss), 10) if len(part)
            ],
            "files": [self.files[0], self.files[-1]],
            "threads": [self.threads[0], self.threads[-1]],
            "grew": (low > GROWTH_LIMIT and rise > RISE_LIMIT) or files > 0 or threads > 0,
        }


def growth(seconds: np.ndarray, megabytes: np.ndarray) -> tuple[float, float, float]:
    """Return the slope of memory over time [MB/h] and its 95 % interval, from the means of `BLOCKS` blocks."""
    blocks = min(BLOCKS, len(seconds))
    if blocks < 3:
        return float("nan"), float("-inf"), float("inf")
    t, m = (np.array([part.mean() for part in np.array_split(x, blocks)]) for x in (seconds / 3600.0, megabytes))
    fit = stats.linregress(t, m)
    half = stats.t.ppf(0.975, blocks - 2) * fit.stderr
    return float(fit.slope), float(fit.slope - half), float(fit.slope + half)


class Watch:
    """Looks at every process of the graph once a second."""

    def __init__(self) -> None:
        self.samples: dict[int, Samples] = {}
        self._next = SETTLE

    def __call__(self, elapsed: float) -> None:
        """Be called often with the seconds since the first tick."""
        if elapsed < self._next:
            return
        self._next += 1.0
        for child in psutil.Process().children():
            self.samples.setdefault(child.pid, Samples()).look(child, elapsed)
        self.samples.setdefault(os.getpid(), Samples()).look(psutil.Process(), elapsed)


def soak(seconds: float, rate: float, domain: int, folder: Path) -> dict[str, Any]:
    """Run the graph in a ROS domain and return every figure."""
    from sher3_bringup.processes.up import run_graph
    from sher3_bringup.settings.run_settings import checked, parse_processes
    from sher3_bringup.surgeon.script import load_script
    from sher3_runtime.ports import STATISTICS_VARIABLE

    (folder / "script.yaml").write_text(SCRIPT)
    script, bag, statistics = load_script(folder / "script.yaml"), folder / "bag", folder / "statistics"
    os.environ[STATISTICS_VARIABLE] = str(statistics)
    settings = checked(
        rate=rate,
        record=bag,
        processes=parse_processes(None, mock=True, record=True),
        duration=seconds,
        domain=domain,
        realtime=-1,
        patience="patient",
    )

    def surgeon() -> list:
        from sher3_bringup.surgeon.teleop_node import script_node

        return [script_node(script)]

    before, watch = places(domain), Watch()
    run_graph(settings, lambda text: print(text, file=sys.stderr), {"surgeon": surgeon}, watch)
    names = ["parent", *("+".join(process) for process in settings.processes), "surgeon", "terminal"]
    pids = [os.getpid(), *sorted(pid for pid in watch.samples if pid != os.getpid())]
    processes = {name: watch.samples[pid].verdict() for name, pid in zip(names, pids, strict=True)}
    nodes = {path.stem: json.loads(path.read_text())["statistics"] for path in sorted(statistics.glob("*.json"))}
    left = left_behind(before, domain)
    return {"processes": processes, "nodes": nodes, "recording": recording(bag), "leftovers": left}


def recording(bag: Path) -> dict[str, Any]:
    """Return size, drops and tip travel of the bag, and the operating states the robot was in."""
    from sher3_bags.reading import read_run

    run = read_run(bag, ["measured_cp", "operating_state", "supervisor/status"], check=False)
    found = [fault for text in run["supervisor/status"].data if (fault := json.loads(text)["first_fault"])]
    drops = {t: json.loads(e)["dropped"] for t, e in run.records["sher3.recording"].items()}
    travel = np.linalg.norm(np.diff(run["measured_cp"].position, axis=0), axis=1).sum()
    return {
        "bytes": sum(path.stat().st_size for path in bag.iterdir()),
        "dropped": {topic: count for topic, count in drops.items() if count},
        "tip_path_mm": float(travel * 1e3),
        "states": sorted(set(run["operating_state"].data)),
        "last_state": run["operating_state"].data[-1],
        "first_fault": found[0] if found else None,
    }


def places(domain: int) -> set[str]:
    """Return what lies in /dev/shm, the Unix sockets of the mocks, and the UDP ports of the domain that are taken."""
    from sher3_bringup.settings.run_settings import MOCK_FORCE_PORT

    found = {f"/dev/shm/{name}" for name in os.listdir("/dev/shm")} if os.path.isdir("/dev/shm") else set()
    found = {name for name in found if "fastrtps" in name or "fastdds" in name or "sher3" in name}
    unix = Path("/proc/net/unix")
    if unix.exists():
        found |= {part for part in unix.read_text().split() if f"sher3-{domain}" in part}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("127.0.0.1", MOCK_FORCE_PORT + 250 * domain))
        except OSError:
            found.add("the port of the mock force sensor")
    return found


def left_behind(before: set[str], domain: int) -> list[str]:
    """Return what was not there before: files, sockets, and child processes that still run."""
    children = [f"process {child.pid} {child.name()}" for child in psutil.Process().children(recursive=True)]
    return sorted(places(domain) - before) + children


def faults(result: dict[str, Any], any_state: bool = False) -> list[str]:
    """Return what makes the soak fail, in words.

    With `any_state` a robot that stopped is no fault, nor are queues that fill while the recorder is held up so long
    that samples are lost: memory is then that of a busy computer.
    """
    busy = any_state and any(result["recording"]["dropped"].values())
    found = [f"{name} grew: {p}" for name, p in result["processes"].items() if p["grew"] and not busy]
    found += [f"left behind: {what}" for what in result["leftovers"]]
    garbage = {name: node["garbage"] for name, node in result["nodes"].items() if node.get("garbage")}
    if garbage:
        found.append(f"invalid messages: {garbage}")
    run = result["recording"]
    if not any_state and run["last_state"] != OperatingState.ENABLED:
        found.append(f"the robot did not stay ENABLED: {run['first_fault'] or run['states']}")
    if not any_state and run["tip_path_mm"] < 0.1:
        found.append(f"the tip did not move: {run['tip_path_mm']} mm")
    return found


def text(result: dict[str, Any]) -> str:
    """Return the figures as tables."""
    lines = ["process            RSS MB   MB/h [95 %]            rise MB  files      threads"]
    for name, p in result["processes"].items():
        slope, low, high = p["slope_mb_per_hour"]
        interval = f"{slope:7.1f} [{low:.1f}, {high:.1f}]"
        counts = "  ".join(f"{a:4} -> {b:<4}" for a, b in (p["files"], p["threads"]))
        lines.append(f"{name:18} {p['rss_mb']:6.1f}  {interval:24} {p['rise_mb']:6.2f}  {counts}")
    lines.append("node               period us p50 p99 max    wake-up us p50 p99 max   lost cycles  overruns  dropped")
    for name, n in result["nodes"].items():
        times = (" ".join(f"{n[k][q] / 1e3:7.0f}" for q in ("p50", "p99", "max")) for k in ("period", "wakeup"))
        lost = f"{n['lost_cycles']:11}  {n['overruns']:8}  {sum(n['dropped'].values()):7}"
        lines.append(f"{name:18} {'   '.join(times)}   {lost}")
    r = result["recording"]
    lines.append(
        f"recording {r['bytes'] / 1e6:.1f} MB, dropped {r['dropped'] or 0}, tip path {r['tip_path_mm']:.1f} mm"
    )
    lines.append(f"states {', '.join(r['states'])}; left behind: {', '.join(result['leftovers']) or 'nothing'}")
    return "\n".join(lines)


def main() -> None:
    """Soak, print the figures, and say what is wrong."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=30.0)
    parser.add_argument("--rate", type=float, default=500.0)
    parser.add_argument("--domain", type=int, default=DOMAIN, help="ROS domain id")
    parser.add_argument("--keep", type=Path, help="keep the bag as this folder")
    parser.add_argument("--any-state", action="store_true", help="a robot that stopped is no failure of the soak")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        result = {"seconds": options.seconds, "rate": options.rate, "load": os.getloadavg()}
        result |= soak(options.seconds, options.rate, options.domain, Path(folder))
        if options.keep:
            shutil.move(Path(folder) / "bag", options.keep)
    result["faults"] = faults(result, options.any_state)
    print(json.dumps(result) if options.json else text(result))
    for fault in result["faults"]:
        print(f"soak: {fault}", file=sys.stderr)
    sys.exit(1 if result["faults"] else 0)


if __name__ == "__main__":
    main()
