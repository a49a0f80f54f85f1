"""A headless Chromium that tests talk to (Chrome DevTools Protocol)."""

from __future__ import annotations

import base64
import json
import shutil
import subprocess
import time
import urllib.request
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "--remote-allow-origins=*",
)


CLICK = "e => { e.click(); return true; }"


class Page:
    """One page of the browser.

    Attributes:
        errors: what the page's scripts complained about.
    """

    def __init__(self, socket: Any) -> None:
        self._socket, self._number = socket, 0
        self.errors: list[str] = []
        self.call("Runtime.enable")
        self.call("Page.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command; return its result."""
        self._number += 1
        self._socket.send(json.dumps({"id": self._number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self._socket.recv(timeout=120.0))
            if message.get("id") == self._number:
                assert "error" not in message, message
                return message["result"]
            if message.get("method") == "Runtime.exceptionThrown":
                self.errors.append(json.dumps(message["params"]["exceptionDetails"])[:500])

    def evaluate(self, script: str) -> Any:
        """Return the value of an expression in the page."""
        return self.call("Runtime.evaluate", expression=script, returnByValue=True)["result"].get("value")

    def text(self) -> str:
        """Return what can be read on the page."""
        return str(self.evaluate("document.body.innerText"))

    def wait(self, there: Callable[[], Any], seconds: float = 60.0) -> Any:
        """Wait until something is there; return it, or what it was at the end."""
        end = time.monotonic() + seconds
        while not (found := there()) and time.monotonic() < end:
            time.sleep(0.2)
        return found

    def click(self, label: str) -> bool:
        """Click the button, the box or the folder that bears a text; return whether there is one."""
        return bool(
            self._on(f"e => e.matches('button, label, div') && e.innerText?.trim() === {json.dumps(label)}", CLICK)
        )

    def fill(self, number: int, text: str) -> bool:
        """Type into a field for numbers, counted from 0; return whether there is one."""
        self.evaluate(f"document.querySelectorAll('input[inputmode=decimal]')[{number}]?.focus()")
        self.evaluate("document.activeElement.select?.()")
        self.call("Input.insertText", text=text)
        return bool(self.evaluate("document.activeElement.blur?.() ?? true"))

    def _on(self, which: str, then: str) -> Any:
        """Do something with the innermost element of a kind."""
        return self.evaluate(
            f"(e => e ? ({then})(e) : false)([...document.querySelectorAll('*')].filter({which}).pop())"
        )

    def screenshot(self, path: Path) -> Path:
        """Write a picture of the page."""
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"]))
        return path


@contextmanager
def browse(url: str, profile: Path, size: tuple[int, int] = (1300, 900)) -> Iterator[Page]:
    """Open a page in a browser of its own."""
    from websockets.sync.client import connect

    assert CHROMIUM, "no Chromium on this machine"
    profile.mkdir(parents=True, exist_ok=True)
    command = [CHROMIUM, *FLAGS, f"--window-size={size[0]},{size[1]}", f"--user-data-dir={profile}", url]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        with connect(_address(profile), max_size=None) as socket:
            yield Page(socket)
    finally:
        process.terminate()
        process.wait(20.0)


def _address(profile: Path) -> str:
    end = time.monotonic() + 60.0
    while time.monotonic() < end:
        try:
            port = int((profile / "DevToolsActivePort").read_text().split()[0])
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=5.0) as answer:
                pages = [page for page in json.load(answer) if page["type"] == "page"]
            if pages:
                return str(pages[0]["webSocketDebuggerUrl"])
        except (OSError, ValueError, IndexError):
            pass
        time.sleep(0.1)
    raise AssertionError("the browser did not start")
