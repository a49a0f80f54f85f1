"""One robot to a namespace of a domain: a lock that the processes of `sher3 up` hold together until the last one ends.

A second robot there would publish the same topics on the same devices. The kernel frees the lock when the last process
that has it open ends, however it ends.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sher3_common.namespace import robot_name
from sher3_drivers.runtime_directory import runtime_directory

from sher3_bringup.errors import AlreadyRunning


@contextmanager
def only_robot(domain: int, folder: Path | None = None) -> Iterator[None]:
    """Be the only robot of this user in its namespace of a ROS domain; forked processes share the lock.

    Args:
        domain: ROS domain id.
        folder: where the lock lies; this user's runtime directory by default.

    Raises:
        AlreadyRunning: a robot is running there, or a process of one has not ended yet.
    """
    path = (folder or runtime_directory()) / f"up-{domain}-{robot_name()}.lock"
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            who = os.pread(descriptor, 32, 0).decode("ascii", "replace") or "unknown"
            remedy = "stop it, or give this one another --domain or --namespace"
            raise AlreadyRunning(
                f"a robot is already running in ROS domain {domain}", value=f"process {who}", remedy=remedy
            ) from None
        os.ftruncate(descriptor, 0)
        os.pwrite(descriptor, str(os.getpid()).encode(), 0)
        yield
    finally:
        os.close(descriptor)
