"""The mutation check of `tools/mutate_guards.py`: that it finds, replaces and judges; all guards under `slow`."""

import importlib.util
import json
import subprocess
import sys

import pytest
from processes import child_environment
from sources import ROOT, SOURCES

TOOL = ROOT / "tools" / "mutate_guards.py"


@pytest.fixture(scope="module")
def tool():
    spec = importlib.util.spec_from_file_location("mutate_guards", TOOL)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_declared_guard_still_stands(tool):
    """A guard that was removed, moved or rewritten is noticed here in milliseconds."""
    guards = tool.load_guards()
    assert len(guards) >= 90 and len({(guard.file, guard.scope, guard.source) for guard in guards}) >= 90
    for guard in guards:
        text = (SOURCES / guard.file).read_text()
        changed = tool.mutated(text, guard)
        assert changed != text and len(changed.splitlines()) <= len(text.splitlines())
        assert all((SOURCES / test if not test.startswith("tests/") else ROOT / test).is_file() for test in guard.tests)


def test_a_vanished_or_ambiguous_guard_is_an_error(tool):
    text = "def f(x):\n    if x > 1:\n        return 2\n    return x > 2 or x > 2\n"
    guard = tool.Guard("n", "f.py", "f", "x > 1", "False", ())
    assert "if (False):" in tool.mutated(text, guard)
    assert "if (False):" in tool.mutated(text, guard._replace(source="if x > 1:"))
    for change in ({"source": "x > 3"}, {"source": "x > 2"}, {"scope": "g"}, {"source": "if x > 2:"}):
        with pytest.raises(tool.Vanished):
            tool.mutated(text, guard._replace(**change))


def test_three_guards_are_missed_when_they_are_gone():
    """The ages of samples, run as the whole list is; a survivor would be exit code 1."""
    run = mutate("--only", "judge_age")
    assert run["guards"] == run["killed"] == 3
    assert all(result["killed_by"] for result in run["results"])


@pytest.mark.slow
@pytest.mark.timeout(7500)
def test_every_guard_is_missed_when_it_is_gone():
    """The limits of time are for a core that other work shares."""
    run = mutate(timeout=7200)
    assert run["guards"] == run["killed"] >= 90


def mutate(*arguments: str, timeout: float = 280.0) -> dict:
    command = [sys.executable, str(TOOL), "--json", *arguments]
    options = {"env": child_environment(), "capture_output": True, "text": True, "timeout": timeout}
    done = subprocess.run(command, check=False, **options)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(done.stdout)
