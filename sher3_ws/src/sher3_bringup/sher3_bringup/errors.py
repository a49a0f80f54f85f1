"""How a run can fail, and the exit code of each."""

from __future__ import annotations

from sher3_common import Sher3Error

USAGE = 2
NOT_STARTED = 3
DIED = 4
KILLED = 5
FAULTED = 6


class ConfigurationError(Sher3Error):
    """The options of a run contradict each other or a limit."""

    exit_code = USAGE


class StartError(Sher3Error):
    """A process could not be started: a device is missing, or the processes did not find each other."""

    exit_code = NOT_STARTED


class AlreadyRunning(StartError):
    """A robot is running in this ROS domain already."""


class NoRealtime(StartError):
    """The real robot is to be started without real-time rights: the kernel may hold its loop up for any time."""

    def __init__(self, priority: int) -> None:
        remedy = f"let this user have them (rtprio {priority} in limits.conf, then log in again), or --realtime 0"
        super().__init__("no permission for real-time priority", limit=f"ulimit -r >= {priority}", remedy=remedy)


class ProcessDied(Sher3Error):
    """A process ended while the robot was running; everything else has been stopped."""

    exit_code = DIED


class NotStopped(Sher3Error):
    """A process did not stop when asked to and had to be killed."""

    exit_code = KILLED


class SessionFailed(Sher3Error):
    """The robot of a recorded session faulted, was not enabled or did not move as its script asked."""

    exit_code = DIED


class EndedInFault(SessionFailed):
    """The robot went to FAULT, and nobody recovered it."""

    exit_code = FAULTED

    def __init__(self, fault: str) -> None:
        super().__init__(f"the robot ended in {' '.join(fault.split())}")
