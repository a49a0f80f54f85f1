"""A terminal in a folder of its own, with a second one in which the robot runs."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

from documentation.commands import Command, in_company, shortened
from documentation.forked_python import ForkedPython
from processes import child_environment
from sources import ROOT

LINKS = ("bench", "tests", "tools", "sher3_ws", "docker", "Makefile", "pyproject.toml")
"""What of the project is seen from the folder."""
ACTIVATION = ". .venv/bin/activate"
LENT = "sher3 up --patient --layout composed"
"""The robot of commands whose page starts none: the page on faults takes 16 s of processor with it, 28 s with a process
for each node."""
START = 120.0
"""Seconds until the robot is up at the latest: the kernels of a new machine are compiled first."""
A_WHILE = 3.0
"""Seconds that a command which ends at Ctrl-C is given."""


class Terminal:
    """Runs the commands of a page.

    Args:
        folder: working folder, made ready with links to the project.
        domain: ROS domain of the robot.
        takes_domain: full names of the commands with an option `--domain`.
        limit: seconds that one command may take.
        empty: the folder has nothing but the environment, whose commands are found after its activation alone.
        forked: what stands for `python` and `sher3` where a command needs no process of its own.
    """

    def __init__(
        self,
        folder: Path,
        domain: int,
        takes_domain: set[str],
        limit: float,
        empty: bool,
        forked: ForkedPython,
    ) -> None:
        self.folder, self.domain, self.takes_domain, self.limit = folder, domain, takes_domain, limit
        self.forked = forked
        self.running: list[tuple[subprocess.Popen, Path]] = []
        self.lent, self.broken = False, False
        self.empty, self.activation = empty, ""
        folder.mkdir(exist_ok=True)
        for name in () if empty else LINKS:
            if not (folder / name).exists():
                (folder / name).symlink_to(ROOT / name)
        (folder / ".venv").symlink_to(sys.prefix)
        (folder / "home").mkdir()

    def run(self, command: Command) -> str:
        """Run one command, check its exit code and return what it printed.

        One that runs until Ctrl-C is started and left running; it has printed what it says when it is ready.
        """
        if command.interrupts:
            self.interrupt()
            return ""
        if command.line.startswith(ACTIVATION):
            self.activation = f"{command.line} && "
        self.broken = self.broken or command.bare.startswith("sher3 fault")
        if command.bare.startswith("sher3 up") and command.exit_code == 0:  # a domain has one robot
            self.interrupt()
        elif command.needs_robot and not self.running:
            self.start(LENT)
            self.lent = True
        elif self.lent and not command.needs_robot:
            # The page did not start it: it is up for the commands that need it, and takes no time from the others.
            self.interrupt()
        if command.forever:
            self.start(command.line)
            return self.running[-1][1].read_text()
        done = subprocess.run(
            self._words(command.line),
            cwd=self.folder,
            env=self._environment(command.own_process),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=self.limit,
            check=False,
        )
        said = "\n".join(log.read_text()[-2000:] for _, log in self.running)
        story = f"{command.line}\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}\nmeanwhile:\n{said}"
        assert done.returncode == command.exit_code, f"exit code {done.returncode}: {story}"
        assert "Traceback" not in done.stderr, story
        return done.stdout + done.stderr

    def start(self, line: str) -> None:
        """Start a command that runs until Ctrl-C, and wait until it is ready."""
        log = self.folder / f"log{len(list(self.folder.glob('log*')))}"
        with log.open("w") as output:
            process = subprocess.Popen(
                self._words(f"exec {line}", own=line),
                cwd=self.folder,
                env=self._environment(),
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
            )
        self.running.append((process, log))
        if not line.startswith("sher3 up"):
            time.sleep(A_WHILE)
            assert process.poll() is None, f"{line} ended by itself: {log.read_text()[-3000:]}"
            return
        end = time.monotonic() + START
        while "ready" not in log.read_text():
            assert process.poll() is None, f"{line} did not start: {log.read_text()[-3000:]}"
            assert time.monotonic() < end, f"{line} is not ready: {log.read_text()[-3000:]}"
            time.sleep(0.1)

    def interrupt(self) -> None:
        """Press Ctrl-C in every other terminal, the newest first; each command must end as it was asked to."""
        while self.running:
            process, log = self.running.pop()
            process.send_signal(signal.SIGINT)
            code = process.wait(timeout=60)
            self.lent = False
            # A robot that the page has broken may end in FAULT, and says so.
            assert code in ((0, 6) if self.broken else (0,)), (
                f"exit code {code} after Ctrl-C: {log.read_text()[-3000:]}"
            )

    def close(self) -> None:
        """End what still runs, whatever happened, and remove the folder's large files."""
        for process, _ in self.running:
            process.send_signal(signal.SIGINT)
        for process, _ in self.running:
            try:
                process.wait(timeout=30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def _words(self, line: str, own: str | None = None) -> list[str]:
        shown = own or line
        asked = in_company(shortened(shown), self.domain, self.takes_domain)
        return ["bash", "-c", f"set -o pipefail; {self.activation}{line.replace(shown, asked)}"]

    def _environment(self, own_process: bool = True) -> dict[str, str]:
        ours = str(Path(sys.executable).parent)
        paths = [path for path in os.environ["PATH"].split(":") if path != ours]
        stand_ins = [] if own_process else [str(self.forked.folder)]
        return child_environment(
            PATH=":".join(paths if self.empty else [*stand_ins, ours, *paths]),
            # A page may write to the home folder; the compiled kernels stay where they are.
            HOME=str(self.folder / "home"),
            XDG_CACHE_HOME=os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache"),
            ROS_DOMAIN_ID=str(self.domain),
            COLUMNS="120",
            MPLBACKEND="agg",
        )
