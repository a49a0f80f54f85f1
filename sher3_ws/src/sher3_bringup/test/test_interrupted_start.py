"""Ctrl-C while the kernels of a new machine are compiled, before a process is there to be stopped."""

import os
import signal

import pytest
from sher3_bringup.processes import up
from sher3_bringup.settings.run_settings import RunSettings


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_what_compiles_and_is_caught_again_afterwards(monkeypatch, number):
    """It was taken up when the robot was ready, a minute later."""
    compiled = []

    def compiling(settings, names):
        os.kill(os.getpid(), number)
        compiled.append(names)

    monkeypatch.setattr(up, "preload", compiling)
    caught, outside = [], signal.getsignal(number)
    signal.signal(number, lambda *_: caught.append(number))
    try:
        with pytest.raises(KeyboardInterrupt):
            up.launch_nodes(None, RunSettings(), 0)
        assert not compiled and not caught
        os.kill(os.getpid(), number)
        assert caught == [number]
    finally:
        signal.signal(number, outside)
