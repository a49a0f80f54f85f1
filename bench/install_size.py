"""Size and time of an installation, part by part: a fresh environment, the wheel with its extras, and what lies there.

    python bench/install_size.py
    python bench/install_size.py dist/sher3-0.2.0-py3-none-any.whl --extra robot
    python bench/install_size.py --python python3.10 --python python3.13

Seconds of the processor are printed beside those of the clock: on a shared machine only they compare. What was
installed then diagnoses a slide whose model lacks 12 N of dry friction.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from importlib.metadata import Distribution, distributions
from pathlib import Path

MEGABYTE = 2**20
SHOWN = 9
"""Largest parts that are listed."""
IMPORT = "import sher3.gap"


CASE = """
import numpy as np
import sher3.gap as gap
t = np.arange(20_000) / 1000.0
w = 2.0 * np.pi * np.array([0.4, 1.1, 1.9])
q = 0.05 * np.sin(np.outer(t, w)).sum(axis=1)
v, a = (0.05 * x.sum(axis=1) for x in (w * np.cos(np.outer(t, w)), -(w**2) * np.sin(np.outer(t, w))))
rng = np.random.default_rng(1)
force = 8.0 * a + 12.0 * np.tanh(v / 1e-4) + 0.2 * rng.standard_normal(len(t))
signals = {"position": {"column": "q", "unit": "m"}, "effort": {"column": "f", "unit": "N"}}
axis = {"name": "slide", "motion": "linear", "mass": 8.0, "encoder_resolution": 1e-6, "signals": signals}
axis["command_law"] = {"kind": "force"}
machine = {"kind": "axes", "name": "slide", "time": {"column": "t"}, "axes": [axis]}
found = gap.diagnose(machine, {"t": t, "q": q + 1e-6 * rng.standard_normal(len(t)), "f": force})
print(found.headline)
"""


def size(part: Distribution) -> int:
    """Return the bytes of a distribution's files, those of compiled Python included."""
    paths = {Path(str(part.locate_file(f))) for f in part.files or ()}
    return sum(p.stat().st_size for p in paths if p.is_file())


def spent(command: list[str]) -> tuple[float, float]:
    """Run a command; return seconds of the clock and of the processor."""
    began, before = time.perf_counter(), os.times()
    subprocess.run(command, check=True)
    after = os.times()
    return time.perf_counter() - began, sum(after[2:4]) - sum(before[2:4])


def built(folder: str) -> Path:
    """Return a wheel of this working copy, built into a folder."""
    pip = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder]
    subprocess.run([*pip, str(Path(__file__).parents[1])], check=True)
    return next(Path(folder).glob("*.whl"))


def shown(interpreter: str, wheel: Path, extra: str) -> None:
    """Install a wheel into a fresh environment of an interpreter, and print the table."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([interpreter, "-m", "venv", folder], check=True)
        python = str(Path(folder) / "bin" / "python")
        what = f"{wheel}[{extra}]" if extra else str(wheel)
        wall, own = spent([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", what])
        spent([python, "-c", IMPORT])
        first = min(spent([python, "-c", IMPORT])[0] for _ in range(5))
        said = subprocess.run([python, "-c", CASE], check=True, capture_output=True, text=True).stdout.strip()
        parts = list(distributions(path=[str(next(Path(folder).glob("lib/python*/site-packages")))]))
        sizes = sorted(((size(p), p.metadata["Name"]) for p in parts if p.metadata["Name"] != "pip"), reverse=True)
    total = sum(x for x, _ in sizes)
    print(
        f"{Path(interpreter).name}: {total / MEGABYTE:.0f} MB in {len(sizes)} packages, {wall:.0f} s, {own:.0f} s of it"
    )
    print(f"of them of the processor; {IMPORT}: {first:.2f} s; a case: {said}")
    for x, name in sizes[:SHOWN]:
        print(f"  {x / MEGABYTE:6.0f} MB  {name}")
    print(f"  {sum(x for x, _ in sizes[SHOWN:]) / MEGABYTE:6.0f} MB  the other {len(sizes[SHOWN:])}")


def main() -> None:
    """Install, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path, nargs="?", help="default: built from this working copy")
    parser.add_argument("--extra", default="")
    parser.add_argument("--python", action="append", help="interpreter; default this one; repeat for more")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        wheel = (given.wheel or built(folder)).resolve()
        for interpreter in given.python or [sys.executable]:
            shown(interpreter, wheel, given.extra)


if __name__ == "__main__":
    main()
