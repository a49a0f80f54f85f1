"""What is said while code is compiled, with a clock that the test moves."""

import io

import pytest
from sher3_common.compiling import telling
from sher3_common.compiling.telling import CLEAR, Telling


class Screen(io.StringIO):
    def __init__(self, terminal):
        super().__init__()
        self.isatty = lambda: terminal


@pytest.fixture
def clock(monkeypatch):
    now = [100.0]
    monkeypatch.setattr(telling.time, "monotonic", lambda: now[0])
    return now


@pytest.mark.parametrize("terminal", [True, False])
def test_a_moment_of_compiling_is_not_told(clock, terminal):
    screen = Screen(terminal)
    told = Telling(screen)
    told.begins()
    clock[0] += 0.9
    told.begins()
    told.ended()
    told.ended()
    assert screen.getvalue() == ""


def test_a_terminal_shows_how_much_and_is_clean_afterwards(clock):
    screen = Screen(True)
    told = Telling(screen)
    told.begins()
    clock[0] += 3.0
    told.begins()
    told.ended()
    assert screen.getvalue() == f"{CLEAR}compiling, once: 2 functions, 3 s"
    told.ended()
    assert screen.getvalue().endswith(f"3 s{CLEAR}")


def test_elsewhere_one_line_says_it(clock):
    screen = Screen(False)
    told = Telling(screen)
    for _ in range(4):
        told.begins()
        clock[0] += 2.0
        told.ended()
    assert screen.getvalue() == "sher3: compiling, once; the next start takes it from the cache\n"
