"""Ctrl-C at any moment of a command's start is exit code 130 and no traceback."""

import subprocess
import sys

import pytest

INTERRUPTED = """
import os, signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)  # tests in the background ignore it
event, left = sys.argv.pop(1), int(sys.argv.pop(1))

def interrupt(name, _):
    global left
    if name == event:
        left -= 1
        if left == 0:
            os.kill(os.getpid(), signal.SIGINT)

sys.addaudithook(interrupt)
from sher3_cli.__main__ import main
main()
"""
"""Interrupts itself at one of the events that Python tells of: an import, or code that is run."""

CUT = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
import sher3_cli.root
from sher3_cli.__main__ import main
text = "import os, signal; os.kill(os.getpid(), signal.SIGINT); [None for _ in range(9)]"
sher3_cli.root.make_app = lambda *_: lambda **_: exec(text)
main()
"""
"""A command that is interrupted in code made of a string."""


@pytest.mark.parametrize(("event", "number"), [("import", 5), ("import", 200), ("exec", 150), ("exec", 400)])
def test_an_interrupt_while_a_command_is_imported_is_its_exit_code(event, number, tmp_path):
    (tmp_path / "interrupted.py").write_text(INTERRUPTED)
    words = [sys.executable, "-m", "interrupted", event, str(number), "up", "--help"]
    ended = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 130, ended
    assert "Traceback" not in ended.stderr


def test_an_interrupt_that_meets_code_made_of_a_string_is_its_exit_code(tmp_path):
    """As the making of a dataclass: Python ended the process by the signal although it was answered."""
    (tmp_path / "cut.py").write_text(CUT)
    ended = subprocess.run([sys.executable, "-m", "cut"], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (ended.returncode, ended.stderr) == (130, "sher3: interrupted\n")
