"""Completion in real shells: what the tab key offers after some words."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

BASH = """
source <(sher3 completion bash)
COMP_WORDS=({words} "{last}"); COMP_CWORD={count}
_sher3_completion sher3
printf '%s\\n' "${{COMPREPLY[@]}}"
"""
ZSH = """
autoload -U compinit && compinit -u
source <(sher3 completion zsh)
_TYPER_COMPLETE_ARGS="{words} {last}" _SHER3_COMPLETE=complete_zsh sher3
"""
FISH = """
sher3 completion fish | source
complete -C "{words} {last}"
"""
CASES = {
    "a command": ("sher3", "tele", "teleop"),
    "a command of a group": ("sher3 gap", "lib", "library"),
    "an effect": ("sher3 gap library", "backl", "backlash"),
    "an option": ("sher3 record", "--dom", "--domain"),
    "a bag": ("sher3 info", "tri", "trial"),
}


@pytest.fixture
def folder(tmp_path) -> Path:
    (tmp_path / "trial").mkdir()
    (tmp_path / "trial" / "trial.mcap").touch()
    return tmp_path


@pytest.fixture
def commands(tmp_path_factory) -> str:
    """Return a PATH with `sher3`: colcon puts it where `ros2 run` looks, which is on nobody's."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    if shutil.which("sher3", path=path):
        return path
    command = tmp_path_factory.mktemp("bin") / "sher3"
    command.write_text(f'#!/bin/sh\nexec {sys.executable} -m sher3_cli "$@"\n')
    command.chmod(0o755)
    return f"{command.parent}{os.pathsep}{path}"


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_tab_key_offers(shell, case, folder, commands):
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not on this machine")
    words, last, offered = CASES[case]
    script = {"bash": BASH, "zsh": ZSH, "fish": FISH}[shell].format(words=words, last=last, count=len(words.split()))
    kept = {name: value for name, value in os.environ.items() if name == "PYTHONPATH"}
    environment = {**kept, "PATH": commands, "HOME": str(folder), "TERM": "dumb"}
    done = subprocess.run(
        [shell, "-c", script], cwd=folder, env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    assert offered in done.stdout, done.stderr
