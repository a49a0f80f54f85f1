"""`sher3 teleop`: join a running mock graph as its surgeon."""

from __future__ import annotations

import os
import select
import shutil
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sher3_bringup.errors import ConfigurationError, EndedInFault, StartError
from sher3_bringup.surgeon.keyboard import HELP, Keyboard
from sher3_bringup.surgeon.script import Script
from sher3_bringup.terminal.screen import Screen
from sher3_bringup.terminal.status_news import UNKNOWN, StatusNews

LISTENED = 5.0
"""Seconds after which a robot that has not been heard is not there: it tells its state once a second."""


def is_over(script: Script, news: StatusNews, elapsed: float) -> bool:
    """Return whether a script has nobody to act on, or has come to its end, `elapsed` seconds after its start."""
    return elapsed >= script.duration or (news.state == UNKNOWN and elapsed >= LISTENED)


def run_script(script: Script, rate: float, domain: int) -> None:
    """Run a script to its end, or until Ctrl-C; print its steps, and each change of state of the robot.

    Raises:
        EndedInFault: the robot was in FAULT at the end; StartError: no robot was heard.
    """
    from sher3_bringup.surgeon.teleop_node import run_node, script_node
    from sher3_bringup.terminal.listener_node import listen

    shown, news, screen = [-1], StatusNews(), Screen()
    nodes: list[Any] = []

    def hear(topic: str, data: dict[str, Any]) -> None:
        for line in news.hear(topic, data):
            screen(f"{nodes[0].elapsed:6.1f} s  {line}")

    def make() -> Any:
        nodes.append(script_node(script))
        listen(nodes[0], hear)
        return nodes[0]

    def stop(node: Any) -> bool:
        step, _ = script.step_at(node.elapsed)
        if step != shown[0]:
            shown[0] = step
            screen(f"{node.elapsed:6.1f} s  {script.steps[step].name}")
        screen.status(news.status())
        return is_over(script, news, node.elapsed)

    run_node(make, stop, rate, domain)
    screen.status("")
    if news.state == UNKNOWN:
        raise StartError("no robot is heard", value=f"domain {domain}", remedy="start `sher3 up`, or name its --domain")
    if news.fault:
        raise EndedInFault(news.fault)


def run_keyboard(rate: float, domain: int, device: Path | None = None) -> None:
    """Run until `q` or Ctrl-C; with a joystick or a SpaceMouse its axes are the hand and its buttons the foot.

    Raises:
        ConfigurationError: standard input is no terminal, or the device cannot be read.
    """
    if not sys.stdin.isatty():
        raise ConfigurationError("standard input is no terminal", remedy="run in a terminal or give a script")
    from sher3_bringup.surgeon.device import Device
    from sher3_bringup.surgeon.keyboard_node import KeyboardNode
    from sher3_bringup.surgeon.teleop_node import run_node

    keyboard = Keyboard()
    stick = None if device is None else Device(device)
    hands = keyboard.hands if stick is None else stick.hands
    screen = _Screen()

    def stop(node: Any) -> bool:
        while select.select([sys.stdin], [], [], 0.0)[0]:
            keyboard.press(os.read(sys.stdin.fileno(), 1).decode("ascii", "ignore"))
        if screen.due():
            hand = keyboard.line() if stick is None else f"{device}, {'pressed' if stick.pressed else 'released'}"
            screen.show(node.look(hand, screen.width))
        return keyboard.quit

    print(HELP)
    with _single_keys():
        run_node(lambda: KeyboardNode(keyboard, hands), stop, rate, domain)
    print()


class _Screen:
    """Lines that are written over at each update; plain escape codes, so that it works over ssh."""

    def __init__(self) -> None:
        self._next, self._lines = 0.0, 0

    @property
    def width(self) -> int:
        """Columns of the terminal."""
        return shutil.get_terminal_size((100, 24)).columns

    def due(self) -> bool:
        """Whether it is time for an update: ten times a second, faster than anybody reads."""
        now = time.monotonic()
        if now < self._next:
            return False
        self._next = now + 0.1
        return True

    def show(self, lines: list[str]) -> None:
        """Write the lines over the ones before."""
        up = f"\x1b[{self._lines - 1}A" if self._lines > 1 else ""
        self._lines = len(lines)
        print("\r" + up + "\n".join(f"{line}\x1b[K" for line in lines), end="", flush=True)


@contextmanager
def _single_keys() -> Iterator[None]:
    """Deliver keys one at a time and unseen."""
    import termios
    import tty

    before = termios.tcgetattr(sys.stdin)
    try:
        tty.setcbreak(sys.stdin)
        yield
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)
