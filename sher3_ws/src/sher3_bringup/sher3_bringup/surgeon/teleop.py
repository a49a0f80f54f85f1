"""`sher3 teleop`: join a running mock graph as its surgeon."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from sher3_bringup.errors import ConfigurationError
from sher3_bringup.surgeon.keyboard import HELP, Keyboard
from sher3_bringup.surgeon.script import Script


def run_script(script: Script, rate: float, domain: int) -> None:
    """Run a script to its end, or until Ctrl-C."""
    from sher3_bringup.surgeon.teleop_node import run_node, script_node

    shown = [-1]

    def stop(node: Any) -> bool:
        step, _ = script.step_at(node.elapsed)
        if step != shown[0]:
            shown[0] = step
            print(f"{node.elapsed:6.1f} s  {script.steps[step].name}", flush=True)
        return node.elapsed >= script.duration

    run_node(lambda: script_node(script), stop, rate, domain)


def run_keyboard(rate: float, domain: int) -> None:
    """Run until `q` or Ctrl-C.

    Raises:
        ConfigurationError: standard input is no terminal.
    """
    if not sys.stdin.isatty():
        raise ConfigurationError("standard input is no terminal", remedy="run in a terminal or give a script")
    from sher3_bringup.surgeon.teleop_node import TeleopNode, run_node

    keyboard = Keyboard()

    def stop(node: Any) -> bool:
        while select.select([sys.stdin], [], [], 0.0)[0]:
            keyboard.press(os.read(sys.stdin.fileno(), 1).decode("ascii", "ignore"))
        if keyboard.changed():
            print(f"\r{keyboard.line()}\x1b[K", end="", flush=True)
        return keyboard.quit

    print(HELP)
    with _single_keys():
        run_node(lambda: TeleopNode(keyboard.hands, keyboard.command), stop, rate, domain)
    print()


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
