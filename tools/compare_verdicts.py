"""Compare the verdicts in two folders: the same answer, to rounding? For changes that must not change an answer.

    sher3 gap diagnose cases/* --out before         # of the earlier commit
    sher3 gap diagnose cases/* --out after          # of this one
    python tools/compare_verdicts.py before after

Prints one line for each verdict that differs and a closing count; exits 1 when any differs or is missing.
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path

IGNORED = {"seconds", "versions"}
"""Fields that differ between two runs of the same program."""
ROUNDING = 1e-6
"""Relative difference of two numbers that counts as rounding: sums are formed in another order."""


def differences(before: object, after: object, path: str = "") -> Iterator[str]:
    """Yield where two JSON values differ by more than rounding, as `path: before -> after`."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in sorted((before.keys() | after.keys()) - IGNORED):
            yield from differences(before.get(key), after.get(key), f"{path}.{key}".lstrip("."))
    elif isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        for index, (old, new) in enumerate(zip(before, after, strict=True)):
            yield from differences(old, new, f"{path}[{index}]")
    elif _number(before) and _number(after):
        if not math.isclose(before, after, rel_tol=ROUNDING, abs_tol=1e-12):  # type: ignore[arg-type]
            yield f"{path}: {before!r} -> {after!r}"
    elif before != after:
        yield f"{path}: {before!r} -> {after!r}"


def _number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def verdicts(folder: Path) -> dict[str, Path]:
    """Return the verdict files below a folder by case: `CASE/verdict.json`, or `CASE.json` as in a challenge."""
    inside = {str(path.parent.relative_to(folder)): path for path in folder.rglob("verdict.json")}
    return {**{path.stem: path for path in folder.glob("*.json")}, **inside}


def main() -> int:
    """Compare and print; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    given = parser.parse_args()
    old, new = verdicts(given.before), verdicts(given.after)
    changed = 0
    for name in sorted(old.keys() | new.keys()):
        if name not in old or name not in new:
            found = [f"only in {given.before if name in old else given.after}"]
        else:
            found = list(differences(json.loads(old[name].read_text()), json.loads(new[name].read_text())))
        changed += bool(found)
        for line in found[:5]:
            print(f"{name}: {line}")
    print(f"{len(old.keys() | new.keys())} verdicts compared, {changed} differ")
    return int(changed > 0 or not old)


if __name__ == "__main__":
    sys.exit(main())
