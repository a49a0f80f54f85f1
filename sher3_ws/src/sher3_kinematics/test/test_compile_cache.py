"""Compiled code is kept apart for every state of the kernel sources."""

from pathlib import Path

import numba
import pytest
from sher3_kinematics import compile_cache


def test_digest_follows_any_kernel_source(tmp_path: Path) -> None:
    (tmp_path / "kernel_a.py").write_text("x = 1\n")
    before = compile_cache.source_digest(tmp_path)
    (tmp_path / "other.py").write_text("y = 1\n")
    assert compile_cache.source_digest(tmp_path) == before
    (tmp_path / "kernel_a.py").write_text("x = 2\n")
    assert compile_cache.source_digest(tmp_path) != before


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
