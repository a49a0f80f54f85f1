"""Compiled code lies in a folder of its module, which depends on sources alone."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

LAW = """
from sher3_common.compiled import compiled, compiled_ieee
from sher3_low import GAIN

@compiled
def law(x):
    return GAIN * x

@compiled_ieee
def ratio(x, y):
    return x / y
"""
RUN = """
import numba
before = dict(vars(numba.config))
from sher3_top.law import law
assert dict(vars(numba.config)) == before
print(law(3.0), law.stats.cache_path, sum(law.stats.cache_hits.values()))
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project of two packages, whose upper one compiles a constant of the lower one into its law."""
    for name, text in (
        ("sher3_top/law.py", LAW),
        ("sher3_top/__init__.py", ""),
        ("sher3_low/__init__.py", "GAIN = 2.0\n"),
    ):
        path = tmp_path / "project" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return tmp_path / "project"


def run(project: Path, script: str = RUN, **environment: str | Path) -> list[str]:
    """Run a script in a new process that sees the project; its cache lies beside the project."""
    given = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA")}
    given |= {"PYTHONPATH": str(project), "XDG_CACHE_HOME": str(project.parent / "cache")}
    given |= {name: str(value) for name, value in environment.items()}
    command = [sys.executable, "-W", "ignore", "-c", script]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=given).stdout.split()


def test_a_changed_constant_below_is_compiled_in(project: Path) -> None:
    first, folder, hits = run(project)
    assert (first, hits) == ("6.0", "0")
    assert Path(folder).parent == project.parent / "cache" / "sher3" / "numba"
    assert Path(folder).name.startswith("sher3_top.law-")
    assert run(project) == [first, folder, "1"]

    (project / "sher3_low/__init__.py").write_text("GAIN = 5.25\n")
    second, other, hits = run(project)
    assert (second, hits) == ("15.75", "0")
    assert other != folder


TOGETHER = """
import sys, time
from pathlib import Path
from sher3_top.law import law, ratio
Path(sys.argv[1]).touch()
while len(list(Path(sys.argv[1]).parent.glob("ready*"))) < 2:
    time.sleep(0.001)
law(3.0), ratio(1.0, 2.0)
print(sum(law.stats.cache_hits.values()) + sum(ratio.stats.cache_hits.values()), ratio(1.0, 0.0))
"""


def test_processes_that_start_together_compile_nothing_twice(project: Path) -> None:
    environment = {**os.environ, "PYTHONPATH": str(project), "XDG_CACHE_HOME": str(project.parent / "cache")}
    environment.pop("NUMBA_CACHE_DIR", None)
    commands = [[sys.executable, "-c", TOGETHER, str(project.parent / f"ready{n}")] for n in range(2)]
    both = [subprocess.Popen(c, env=environment, stdout=subprocess.PIPE, text=True) for c in commands]
    said = [process.communicate(timeout=60)[0].split() for process in both]
    assert sum(int(hits) for hits, _ in said) == 2
    assert {infinite for _, infinite in said} == {"inf"}, "a division by zero in IEEE arithmetic"


def test_the_users_folder_stays_in_force(project: Path, tmp_path: Path) -> None:
    *_, folder, _ = run(project, NUMBA_CACHE_DIR=tmp_path / "chosen")
    assert Path(folder).parent == tmp_path / "chosen"
    assert not (project.parent / "cache").exists()


def test_without_a_folder_it_compiles_without_a_cache(project: Path, tmp_path: Path) -> None:
    """A file where the folder should be refuses every user, the administrator too."""
    (tmp_path / "cache").write_text("")
    assert run(project) == ["6.0", "None", "0"]


def test_with_numba_switched_off_it_is_plain_python(project: Path) -> None:
    script = "from sher3_top.law import law; print(law(3.0), type(law).__name__)"
    assert run(project, script, NUMBA_DISABLE_JIT="1") == ["6.0", "function"]


def test_folders_unused_for_a_week_are_removed(project: Path) -> None:
    root = project.parent / "cache" / "sher3" / "numba"
    week = 7 * 24 * 3600
    for name, age in (("old", week + 60), ("recent", week - 60)):
        (root / name).mkdir(parents=True)
        os.utime(root / name, (0, time.time() - age))
    run(project)
    assert sorted(path.name.split("-")[0] for path in root.iterdir()) == ["recent", "sher3_top.law"]


def test_the_order_of_imports_does_not_matter(project: Path) -> None:
    """Each package alone, or after the others: the same folder."""
    names = ["kinematics.kernel.delta.rail_up", "sim.kernel.transmission.place", "bags.mcap.kernels.count_records"]
    script = (
        "from importlib import import_module as load\n"
        "for name in {names}:\n"
        "    module, _, function = ('sher3_' + name).rpartition('.')\n"
        "    print(getattr(load(module), function).stats.cache_path)\n"
    )
    forward = run(project, script.format(names=names))
    assert run(project, script.format(names=names[::-1])) == forward[::-1]
    assert len(set(forward)) == 3


def test_asking_for_the_decorator_does_not_load_numba(project: Path) -> None:
    assert run(project, "import sys, sher3_common.compiled; print('numba' in sys.modules)") == ["False"]
