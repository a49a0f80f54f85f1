"""The live view beside a run: a process of its own that is no part of the robot, so that nothing stops when it ends."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from sher3_view.errors import ExtraMissing

POLITE = 10
"""Niceness of the view: it draws when nothing else wants the processor."""
ENDS_WITHIN = 5.0
"""Seconds after which a view that does not end is killed."""


@contextmanager
def onlooker(wanted: bool, domain: int, port: int) -> Iterator[None]:
    """Show the robot of a domain in the browser while the block runs, on `port` of the loopback interface.

    Raises:
        ExtraMissing: viser is not installed.
    """
    if not wanted:
        yield
        return
    if find_spec("viser") is None:
        raise ExtraMissing("viser")
    command = [sys.executable, "-m", "sher3_view.live.alone", str(domain), str(port)]
    # A session of its own: Ctrl-C is for the robot, which ends the view when it has stopped.
    process = subprocess.Popen(command, preexec_fn=lambda: os.nice(POLITE), start_new_session=True)
    try:
        yield
    finally:
        process.terminate()
        try:
            process.wait(ENDS_WITHIN)
        except subprocess.TimeoutExpired:
            process.kill()
