"""Mutation check of the safety guards: take each one out in a copy of the sources and see a test fail.

    python tools/mutate_guards.py                     # every guard of guards.yaml
    python tools/mutate_guards.py --only supervisor --json

Prints guard -> the test that noticed. Exit code 1 when a guard survives, 2 when one is no longer where the list says,
or the tests fail without any change. Numba is switched off, so a changed formula is not compiled for minutes; the
working tree is never touched.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import yaml

ROOT = Path(__file__).resolve().parent.parent
NOT_COMPILED = "not (out_of_reach or kinematics_fail or impossible_ or before_every_end or resting_plant or in_effort)"
"""Not run: tests of numba's arithmetic (NaN where Python raises) or of the plant, and one of 25 s without numba."""
ATTEMPTS = 3
"""Runs of unchanged tests of which one must pass."""


class Guard(NamedTuple):
    """One guard.

    Attributes:
        name: what it keeps from happening.
        file: under `sher3_ws/src`.
        scope: function or class, dotted.
        source: expression or statement, as `ast.unparse` writes it; `if TEST:` is the test of that condition.
        to: what replaces it.
        tests: files that must notice, under `sher3_ws/src` or the project's `tests`.
    """

    name: str
    file: str
    scope: str
    source: str
    to: str
    tests: tuple[str, ...]


def load_guards(path: Path = ROOT / "tools" / "guards.yaml") -> list[Guard]:
    """Return the declared guards in their order."""
    groups = yaml.safe_load(path.read_text())
    return [
        Guard(row["name"], group["file"], row["in"], row["source"], row["to"], tuple(group["tests"]))
        for group in groups
        for row in group["guards"]
    ]


class Vanished(Exception):
    """A guard is not where the list says."""


def scope_of(tree: ast.Module, dotted: str) -> ast.AST:
    """Return the function or class of a dotted name."""
    node: ast.AST = tree
    for name in dotted.split("."):
        found = [
            child
            for child in ast.iter_child_nodes(node)
            if isinstance(child, ast.FunctionDef | ast.ClassDef) and child.name == name
        ]
        if len(found) != 1:
            raise Vanished(f"no {dotted}")
        node = found[0]
    return node


def mutated(text: str, guard: Guard) -> str:
    """Return the source with the guard replaced.

    Raises:
        Vanished: the guard stands there not once.
    """
    condition = guard.source.endswith(":")
    read = ast.parse(guard.source + " pass" if condition else guard.source).body[0]
    wanted = ast.unparse(read.test if isinstance(read, ast.If) else read)
    nodes = list(ast.walk(scope_of(ast.parse(text), guard.scope)))
    if condition:
        nodes = [node.test for node in nodes if isinstance(node, ast.If)]
    places = {
        (node.lineno, node.col_offset, node.end_lineno or 0, node.end_col_offset or 0)
        for node in nodes
        if isinstance(node, ast.expr | ast.stmt) and ast.unparse(node) == wanted
    }
    if len(places) != 1:
        raise Vanished(f"{guard.file}: {guard.scope} has `{guard.source}` {len(places)} times, not once")
    ((line, column, end_line, end_column),) = places
    lines = [part.encode() for part in text.splitlines(keepends=True)]
    new = f"({guard.to})" if condition or isinstance(read, ast.Expr) else guard.to
    before, after = lines[line - 1][:column], lines[end_line - 1][end_column:]
    changed = b"".join(lines[: line - 1]) + before + new.encode() + after + b"".join(lines[end_line:])
    ast.parse(changed)
    return changed.decode()


class Overlay:
    """A copy of sources and tests in which one file at a time is changed."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        ignore = shutil.ignore_patterns("__pycache__", "*.egg-info", "*.mcap")
        for part in ("sher3_ws", "tests", "bench", "docs", "tools"):
            shutil.copytree(ROOT / part, folder / part, ignore=ignore)
        for name in ("pyproject.toml", "README.md", "requirements.txt", "Makefile"):
            if (ROOT / name).exists():
                shutil.copy(ROOT / name, folder / name)
        self.sources = folder / "sher3_ws" / "src"
        packages = sorted(str(path.parent) for path in self.sources.glob("*/package.xml"))
        self.environment = {**os.environ, "PYTHONPATH": os.pathsep.join([*packages, str(folder / "tests")])}
        # The wheels' start-up hook re-executes Python unless both of its variables are there.
        if "LD_LIBRARY_PATH" not in self.environment:
            self.environment.pop("_ROS_WHEELS_BOOTSTRAP_COMPLETE", None)
        self.environment |= {"NUMBA_DISABLE_JIT": "1", "PYTHONDONTWRITEBYTECODE": "1"}

    def run(self, tests: Sequence[str]) -> tuple[int, str]:
        """Run test files up to the first failure; return pytest's exit code and the failed test or the last lines."""
        files = [test if test.startswith("tests/") else f"sher3_ws/src/{test}" for test in tests]
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--no-header", "-rfE"]
        command += ["-m", "not slow and not graph", "-k", NOT_COMPILED, *files]
        run = subprocess.run(
            command, cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False
        )
        failed = re.search(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.M)
        return run.returncode, failed.group(1).split("::", 1)[-1] if failed else (run.stdout + run.stderr)[-600:]

    def require_sound(self, tests: Sequence[str]) -> None:
        """Run unchanged tests; those in wall time may fail on a shared computer, but not `ATTEMPTS` times in a row.

        Raises:
            Vanished: they fail as they are.
        """
        for _ in range(ATTEMPTS):
            status, said = self.run(tests)
            if status == 0:
                return
        raise Vanished(f"the unchanged tests fail ({', '.join(tests)}): {said}")

    def try_guard(self, guard: Guard) -> dict[str, Any]:
        """Take one guard out, run its tests, put it back."""
        path, begin = self.sources / guard.file, time.monotonic()
        original = path.read_text()
        path.write_text(mutated(original, guard))
        try:
            status, said = self.run(guard.tests)
        finally:
            path.write_text(original)
        place = f"{Path(guard.file).stem}.{guard.scope}"
        killed = status == 1  # a mutant that cannot even be collected (2) was noticed by no test
        return {
            "guard": guard.name,
            "place": place,
            "killed_by": said if killed else None,
            "seconds": round(time.monotonic() - begin, 1),
            "trouble": None if status in (0, 1) or killed else said,
        }


def check(guards: Sequence[Guard], folder: Path) -> Iterator[dict[str, Any]]:
    """Yield one result per guard; the unchanged tests must pass first.

    Raises:
        Vanished: a guard is not where the list says, or the tests fail as they are.
    """
    overlay = Overlay(folder)
    for guard in guards:
        mutated((overlay.sources / guard.file).read_text(), guard)
    for tests in dict.fromkeys(guard.tests for guard in guards):
        overlay.require_sound(tests)
    for guard in guards:
        yield overlay.try_guard(guard)


def main() -> None:
    """Check and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", default=[""], help="guards whose name or place contains one of these")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    places = {guard: f"{guard.name} {guard.file} {guard.scope}" for guard in load_guards()}
    guards = [guard for guard, place in places.items() if any(part in place for part in options.only)]
    results = []
    try:
        with tempfile.TemporaryDirectory() as folder:
            for result in check(guards, Path(folder)):
                results.append(result)
                if not options.json:
                    noticed = result["killed_by"] or f"SURVIVES {result['trouble'] or ''}"
                    print(f"{result['guard']:42} {result['place']:42} {result['seconds']:5} s  {noticed}", flush=True)
    except Vanished as error:
        print(f"mutate_guards: {error}", file=sys.stderr)
        sys.exit(2)
    survivors = [result for result in results if result["killed_by"] is None]
    summary = {"guards": len(results), "killed": len(results) - len(survivors)}
    print(json.dumps({**summary, "results": results}) if options.json else summary)
    sys.exit(1 if survivors else 0)


if __name__ == "__main__":
    main()
