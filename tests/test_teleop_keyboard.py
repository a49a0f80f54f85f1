"""The keyboard in a real terminal: what is pressed reaches the robot, and the robot answers on the same terminal."""

from __future__ import annotations

import contextlib
import os
import pty
import re
import subprocess
import time

import pytest
from processes import child_environment, sher3_command

pytestmark = [pytest.mark.graph, pytest.mark.slow, pytest.mark.flaky(reruns=2)]


class Terminal:
    """A terminal with `sher3 teleop` in it."""

    def __init__(self, domain: int) -> None:
        self.master, slave = pty.openpty()
        command = sher3_command("teleop", "--domain", str(domain))
        environment = child_environment(COLUMNS="160", TERM="xterm")
        self.process = subprocess.Popen(command, stdin=slave, stdout=slave, stderr=slave, env=environment)
        os.close(slave)
        os.set_blocking(self.master, False)

    def press(self, keys: str) -> None:
        os.write(self.master, keys.encode())

    def shows(self, pattern: str, seconds: float = 40.0) -> str:
        """Wait until what is written from now on holds a pattern."""
        text, end = "", time.monotonic() + seconds
        while not re.search(pattern, text) and time.monotonic() < end:
            time.sleep(0.05)
            try:
                text += os.read(self.master, 65536).decode("utf-8", "replace")
            except BlockingIOError:
                continue
        assert re.search(pattern, text), text[-1500:]
        return text

    def asks(self, key: str, pattern: str, tries: int = 20) -> str:
        """Press a key once more, every second, until the answer holds a pattern: the robot may not have it yet."""
        for _ in range(tries - 1):
            self.press(key)
            with contextlib.suppress(AssertionError):
                return self.shows(pattern, 1.0)
        self.press(key)
        return self.shows(pattern)


@pytest.fixture
def terminal(domain):
    options = ["--patient", "--duration", "120", "--domain", str(domain)]
    robot = subprocess.Popen(sher3_command("up", *options), env=child_environment())
    terminal = Terminal(domain)
    try:
        yield terminal
    finally:
        for process in (terminal.process, robot):
            process.terminate()
            process.wait(30.0)
        os.close(terminal.master)


def test_keys_reach_the_robot_and_it_answers(terminal):
    terminal.shows("state   DISABLED")
    terminal.press("z")
    terminal.shows("refused .*pause")
    terminal.asks("t", "answer  tare done: force")  # it wants half a second of samples
    terminal.press("e")
    terminal.shows("state   ENABLED")
    terminal.press("pwwwww")
    terminal.shows(r"[1-9]\.\d\d mm/s|0\.[1-9]\d mm/s")
    terminal.press("t")
    terminal.shows("refused .*tare refused")
    terminal.press("h")
    terminal.shows("remote centre cannot change while the pedal is pressed")
    terminal.press(" p")
    terminal.shows("pedal 0%")
    terminal.press("hg")
    terminal.shows(r"refused .*regime cannot change from bench")
    terminal.shows(r"regime bench   remote centre [+-]")
    terminal.press("z")
    terminal.shows("state   PAUSED")
    terminal.press("q")
    assert terminal.process.wait(20.0) == 0
