"""Whether the robot finishes without a trip beside a busy computer, or refuses at the start with what to do.

    python bench/busy_starts.py --runs 20        # `sher3 demo` and `sher3 up`, 20 each, beside four busy processes
    python bench/busy_starts.py --runs 2 --load 1 --only up --json

The robot has no real-time rights here: `--realtime 0` for `up`; the demo asks for none. A run has *finished* when its
exit code is 0, *refused* when it ended before the robot was enabled and named a remedy, *unended* when it took longer
than three minutes, and *tripped* otherwise. Exit code 1 when a run tripped or did not end.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

COMMANDS = {
    "demo": ("demo", "--domain", "{domain}", "--folder", "{folder}"),
    "up": ("up", "--mock", "--realtime", "0", "--duration", "6", "--domain", "{domain}"),
}
REFUSED = ("NotStarted", "waited in vain", "StartError", "not ready")
"""Words of an end before the robot was enabled."""
PATIENCE = 180.0
"""Longest time of a run, s."""


@contextmanager
def busy(processes: int) -> Iterator[None]:
    """Keep so many processes busy, at ordinary priority."""
    hogs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(processes)]
    try:
        yield
    finally:
        for hog in hogs:
            hog.kill()
            hog.wait()


def run(name: str, domain: int) -> tuple[str, str]:
    """Run a command once; return what came of it and the last line that it said."""
    with tempfile.TemporaryDirectory() as folder:
        words = [word.format(domain=domain, folder=folder) for word in COMMANDS[name]]
        sher3 = str(Path(sys.executable).with_name("sher3"))
        try:
            done = subprocess.run([sher3, *words], capture_output=True, text=True, timeout=PATIENCE, cwd=folder)
        except subprocess.TimeoutExpired:
            return "unended", f"no end within {PATIENCE:g} s"
    said = [line for line in done.stderr.splitlines() if line.strip()] or [""]
    if done.returncode == 0:
        return "finished", ""
    refused = any(word in line for line in said for word in REFUSED)
    return "refused" if refused else "tripped", f"exit {done.returncode}: {said[-1]}"


def main() -> int:
    """Run the bench; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=20, help="of each command")
    parser.add_argument("--load", type=int, default=4, help="busy processes beside them")
    parser.add_argument("--only", choices=COMMANDS, help="one command alone")
    parser.add_argument("--domain", type=int, default=76)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    found: dict[str, dict[str, list[str]]] = {}
    with busy(options.load):
        for name in [options.only] if options.only else COMMANDS:
            ends: dict[str, list[str]] = {"finished": [], "refused": [], "unended": [], "tripped": []}
            for number in range(options.runs):
                what, said = run(name, options.domain)
                ends[what].append(said)
                print(f"{name} {number + 1}: {what} {said}", file=sys.stderr, flush=True)
            found[name] = ends
    counts = {name: {what: len(said) for what, said in ends.items()} for name, ends in found.items()}
    if options.json:
        print(json.dumps(found))
    else:
        print("\n".join(f"{name}: {', '.join(f'{n} {what}' for what, n in c.items())}" for name, c in counts.items()))
    return int(any(c["tripped"] or c["unended"] for c in counts.values()))


if __name__ == "__main__":
    sys.exit(main())
