"""One run of the graph for `graph.py`: prints the processor time of each process as the last line.

Above 1 kHz no classic CAN bus carries the cycle, and `sher3 up` refuses the rate. The mocks' cable has no bit rate, so
here both checks are lifted, to see what the loop itself would do.
"""

from __future__ import annotations

import json
import sys
import time
from contextlib import nullcontext
from pathlib import Path
from tempfile import NamedTemporaryFile
from unittest.mock import patch

import psutil
from sher3_bringup.processes.up import launch_order, run_graph
from sher3_bringup.settings.run_settings import RATES, checked, parse_processes
from sher3_bringup.surgeon.script import load_script
from sher3_drivers.settings import MotorDriverSettings

PUSH = """
schema: sher3.teleop/1
steps:
  - {name: settle, duration: 0.7}
  - {name: recover, duration: 0.3, command: disable}
  - {name: enable, duration: 0.5, command: enable}
  - {name: push, duration: 3600, pedal: 1.0, dither: [1.0, 0.8, 0.5, 0, 0, 0], frequency: 0.5}
"""


class CpuTimes:
    """Processor time of the processes of the graph between the settling time and the last look."""

    def __init__(self, settle: float) -> None:
        self._settle = settle
        self._first: dict[int, float] = {}
        self._last: dict[int, float] = {}
        self._begin = self._end = 0.0
        self._seen = 0.0

    def __call__(self, elapsed: float) -> None:
        """Look every half second."""
        if elapsed < self._settle or elapsed - self._seen < 0.5:
            return
        self._seen = self._end = elapsed
        self._last = {p.pid: sum(p.cpu_times()[:2]) for p in psutil.Process().children()}
        if not self._first:
            self._first, self._begin = self._last, elapsed

    def percent(self) -> list[float]:
        """Return the percent of a core that each process took, in the order they were started."""
        span = self._end - self._begin
        return [100.0 * (self._last[pid] - self._first[pid]) / span for pid in sorted(self._last)]


def main() -> None:
    """Run the graph with a surgeon who pushes all the time."""
    rate, seconds, settle = map(float, sys.argv[1:4])
    realtime, domain = map(int, sys.argv[4:6])
    nodes, record = sys.argv[6:8]
    layouts = ("separate", "composed")
    text, layout = (None, nodes) if nodes in layouts else (nodes, "separate")
    with NamedTemporaryFile("w", suffix=".yaml") as file:
        file.write(PUSH)
        file.flush()
        script = load_script(Path(file.name))
    settings = checked(
        rate=min(rate, RATES[1]),
        processes=parse_processes(text, True, bool(record), layout=layout),
        record=Path(record) if record else None,
        duration=seconds + 0.5,
        realtime=realtime,
        domain=domain,
        patience="patient",
    ).model_copy(update={"rate": rate})

    def surgeon() -> list:
        from sher3_bringup.surgeon.teleop_node import script_node

        return [script_node(script)]

    cpu = CpuTimes(settle)
    begin = time.monotonic()
    with patch.object(MotorDriverSettings, "budgets", lambda _: []) if rate > RATES[1] else nullcontext():
        run_graph(settings, lambda text: print(text, file=sys.stderr), {"surgeon": surgeon}, cpu)
    names = ["+".join(process) for process in launch_order(settings.processes)] + ["surgeon"]
    share = dict(zip(names, cpu.percent(), strict=True))
    watching, load = share.get("supervisor", 0.0), share["surgeon"]
    recorder = share.get("recorder", 0.0)
    loop = sum(share.values()) - watching - load - recorder
    sums = {"cpu_loop": loop, "cpu_supervisor": watching, "cpu_bench": load, "cpu_recorder": recorder}
    print(json.dumps({"cpu": share, **sums, "wall": time.monotonic() - begin}))


if __name__ == "__main__":
    main()
