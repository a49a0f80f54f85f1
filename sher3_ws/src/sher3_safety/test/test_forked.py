"""A call in a fork answers as one here does, and changes nothing here."""

import os
import signal
import time

import pytest
from sher3_safety.search import forked as forks
from sher3_safety.search.forked import ForkEnded, forked


def test_a_fork_answers_and_leaves_everything_here_as_it_was():
    seen = [1.5]

    def call():
        seen.append(0.1)
        return sum(seen), os.getpid()

    answers = [forked(call) for _ in range(3)]
    assert [answer for answer, _ in answers] == [1.6] * 3 and seen == [1.5]
    assert os.getpid() not in [process for _, process in answers]


def test_a_long_answer_comes_whole():
    assert forked(lambda: b"x" * 1_000_000) == b"x" * 1_000_000


def test_a_fork_that_fails_is_an_error_and_prints_what_it_raised(capfd):
    with pytest.raises(ForkEnded, match="without an answer"):
        forked(lambda: 1 // 0)
    assert "ZeroDivisionError" in capfd.readouterr().err


def test_a_fork_that_waits_for_ever_ends_whatever_its_parent_does_with_alarms(monkeypatch):
    """A lock of the middleware, held by a thread that is not in the fork, kept one for a whole test run."""
    monkeypatch.setattr(forks, "LONGEST", 1)
    before = signal.signal(signal.SIGALRM, lambda *_: None)
    try:
        with pytest.raises(ForkEnded, match="without an answer"):
            forked(lambda: time.sleep(30))
    finally:
        signal.signal(signal.SIGALRM, before)
