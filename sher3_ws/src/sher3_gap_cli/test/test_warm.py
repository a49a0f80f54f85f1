"""What the set-up compiles the laws with is a diagnosis that goes all the way: a fault is found and named."""

import sys

import pytest
from sher3_gap_cli import warm


def test_the_case_of_the_set_up_names_its_cause():
    assert warm.warm_up() == "attributed"


def test_without_readers_of_recordings_it_names_their_extra(monkeypatch):
    monkeypatch.setattr(warm, "warm_up", lambda: __import__("mcap"))
    monkeypatch.setitem(sys.modules, "mcap", None)
    with pytest.raises(SystemExit, match=r"no mcap; pip install 'sher3\[bags\]'"):
        warm.main()
