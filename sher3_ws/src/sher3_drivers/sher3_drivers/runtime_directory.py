"""The private directory in which processes of one user on one machine meet: sockets of the local bus and pedal."""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from sher3_drivers.errors import LinkError


def runtime_directory() -> Path:
    """Return this user's private runtime directory; it is made when it is missing.

    It is `$XDG_RUNTIME_DIR/sher3`, or a directory with the user's number where temporary files go.

    Raises:
        LinkError: the directory belongs to somebody else, or others may enter it.
    """
    base = os.environ.get("XDG_RUNTIME_DIR")
    path = Path(base) / "sher3" if base else Path(tempfile.gettempdir()) / f"sher3-{os.getuid()}"
    path.mkdir(mode=0o700, parents=True, exist_ok=True)
    status = path.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o077:
        mode = f"owner {status.st_uid}, mode {stat.S_IMODE(status.st_mode):o}"
        raise LinkError(
            "the runtime directory is not private",
            link=str(path),
            value=mode,
            limit=f"owner {os.getuid()}, mode 700",
            remedy="remove it",
        )
    return path
