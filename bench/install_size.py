"""Size and time of an installation, part by part: a fresh environment, the wheel with its extras, and what lies there.

    python bench/install_size.py
    python bench/install_size.py dist/sher3-0.2.0-py3-none-any.whl --extra robot

Seconds of the processor are printed beside those of the clock: on a shared machine only they compare.
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


def main() -> None:
    """Install, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("wheel", type=Path, nargs="?", help="default: built from this working copy")
    parser.add_argument("--extra", default="")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-m", "venv", folder], check=True)
        python = str(Path(folder) / "bin" / "python")
        wheel = (given.wheel or built(folder)).resolve()
        what = f"{wheel}[{given.extra}]" if given.extra else str(wheel)
        wall, own = spent([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", what])
        spent([python, "-c", IMPORT])
        first = min(spent([python, "-c", IMPORT])[0] for _ in range(5))
        parts = list(distributions(path=[str(next(Path(folder).glob("lib/python*/site-packages")))]))
        sizes = sorted(((size(p), p.metadata["Name"]) for p in parts if p.metadata["Name"] != "pip"), reverse=True)
    total = sum(x for x, _ in sizes)
    print(f"{total / MEGABYTE:.0f} MB in {len(sizes)} packages, {wall:.0f} s, {own:.0f} s of the processor")
    print(f"{IMPORT}: {first:.2f} s")
    for x, name in sizes[:SHOWN]:
        print(f"  {x / MEGABYTE:6.0f} MB  {name}")
    print(f"  {sum(x for x, _ in sizes[SHOWN:]) / MEGABYTE:6.0f} MB  the other {len(sizes[SHOWN:])}")


if __name__ == "__main__":
    main()
