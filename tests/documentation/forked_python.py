"""A Python that has loaded the large libraries once, and forks for each script of a page.

A process of its own takes 1 s of processor to load them, as long as most scripts run. None of the project's modules is
among them: each script loads those as a reader's does. It has the folder, environment, files and exit code of the
command that stands for it: `python` and `sher3` in `ForkedPython.folder`.
"""

from __future__ import annotations

import gc
import json
import os
import runpy
import signal
import socket
import subprocess
import sys
from importlib import import_module
from pathlib import Path

LIBRARIES = (
    *("numpy", "scipy.linalg", "scipy.optimize", "scipy.signal", "scipy.spatial.transform", "scipy.io", "numba"),
    *("matplotlib.backends.backend_agg", "matplotlib.figure", "mpl_toolkits.mplot3d"),
    *("pydantic", "typer", "typer.rich_utils", "rich.console", "yaml", "jinja2"),
)
STAND_IN = """#!{python} -IS
import json, os, socket, sys
with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as server:
    server.connect({address!r})
    asked = [{script!r}, *sys.argv[1:]][{first}:], os.getcwd(), dict(os.environ)
    socket.send_fds(server, [json.dumps(asked).encode()], [0, 1, 2])
    code = int(server.recv(16) or 1)
sys.exit(code if code >= 0 else 128 - code)
"""
"""A command that has its script run by the server; of `python`, the script is the first word behind it."""
LARGEST = 1 << 20
"""Most bytes of a request: words, folder and environment."""


class ForkedPython:
    """Starts the server when its commands are asked for, and ends it with `close`."""

    def __init__(self, store: Path) -> None:
        self._store, self._server = store, None

    @property
    def folder(self) -> Path:
        """Folder with the commands `python` and `sher3`, to stand first in `PATH`."""
        if self._server is None:
            from processes import child_environment

            address = self._store / "socket"
            for name, script, first in (("python", "", 1), ("sher3", str(Path(sys.prefix, "bin", "sher3")), 0)):
                text = STAND_IN.format(python=sys.executable, address=str(address), script=script, first=first)
                (self._store / name).write_text(text)
                (self._store / name).chmod(0o755)
            command = [sys.executable, __file__, str(address)]
            environment = child_environment(MPLBACKEND="agg", COLUMNS="120")
            self._server = subprocess.Popen(command, stdout=subprocess.PIPE, env=environment)
            assert self._server.stdout.readline(), "the forking Python did not start"
        return self._store

    def close(self) -> None:
        """End the server."""
        if self._server is not None:
            self._server.terminate()
            self._server.communicate()


def serve(address: str) -> str:
    """Fork at each request; return, in the fork alone, the script that it is to run."""
    for name in LIBRARIES:
        import_module(name)
    import_module("numba").njit(lambda x: x)(1.0)
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as listener:
        listener.bind(address)
        listener.listen()
        print("ready", flush=True)
        while True:
            asked, _ = listener.accept()
            if os.fork() == 0:
                signal.signal(signal.SIGCHLD, signal.SIG_DFL)
                return _script(asked)
            asked.close()


def _script(asked: socket.socket) -> str:
    """Become the process that was asked for; wait for it in a process that tells its exit code."""
    request, files, _, _ = socket.recv_fds(asked, LARGEST, 3)
    if child := os.fork():
        asked.sendall(str(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])).encode())
        os._exit(0)
    asked.close()
    for number, file in enumerate(files):
        os.dup2(file, number)
        os.close(file)
    sys.argv, folder, environment = json.loads(request)
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    return sys.argv[0]


if __name__ == "__main__":
    script = serve(sys.argv[1])
    sys.path[0] = str(Path(script).absolute().parent)
    runpy.run_path(script, run_name="__main__")
