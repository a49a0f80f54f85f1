"""Compiled code is kept apart for every state of the sources."""

from pathlib import Path

import numba
import pytest
from sher3_kinematics import compile_cache


def test_digest_follows_any_source(tmp_path: Path) -> None:
    """A constant that another package compiles in may stand in any of them."""
    (tmp_path / "kernel_a.py").write_text("x = 1\n")
    found = [compile_cache.source_digest(tmp_path)]
    (tmp_path / "notes.txt").write_text("nothing\n")
    assert compile_cache.source_digest(tmp_path) == found[0]
    for name, text in (("kernel_a.py", "x = 2\n"), ("other.py", "y = 1\n"), ("other.py", "y = 2\n")):
        (tmp_path / name).write_text(text)
        found.append(compile_cache.source_digest(tmp_path))
    assert len(set(found)) == 4


def test_folder_is_named_by_the_sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    folder = compile_cache.select_cache_folder()
    assert folder is not None
    assert folder.is_relative_to(tmp_path)
    assert str(folder) == numba.config.CACHE_DIR


def test_users_folder_stays_in_force(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/somewhere")
    assert compile_cache.select_cache_folder() is None
