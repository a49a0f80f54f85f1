"""The force sensor as its node sees it, and the one within a process for stepped tests."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from sher3_common.vectors import Wrench


class WrenchRecord(NamedTuple):
    """One reading of the sensor.

    Attributes:
        wrench: (fx, fy, fz, mx, my, mz) in the sensor frame {f}, N and N m, as the device gave it.
        sequence: the device's 32-bit record counter.
        status: the device's status word, 0 when it is well.
        drained: number of records taken in since the last reading, this one included; more than one when the device is
            faster than the loop.
    """

    wrench: Wrench
    sequence: int
    status: int = 0
    drained: int = 1


class ForceSensorDevice(Protocol):
    """A force sensor back-end."""

    def read(self, since: int, timeout: float) -> WrenchRecord | None:
        """Return the newest record that arrived at `since` (ns of the driver's clock) or later.

        Waits for one at most `timeout` s; None when none came.

        Raises:
            DeviceMissing: the device is gone.
        """

    def close(self) -> None:
        """Let the device go."""


class InProcessForceSensor:
    """A sensor whose device end is a method call; for stepped tests and single-process runs.

    Attributes:
        tamper: takes a reading and returns those that are sent: none, one or more. The seam for injected faults.
    """

    def __init__(self) -> None:
        self.tamper: Callable[[WrenchRecord], list[WrenchRecord]] | None = None
        self._record: WrenchRecord | None = None
        self._sequence = 0

    def put(self, wrench: Wrench, status: int = 0) -> None:
        """Be the device: produce one record."""
        self._sequence += 1
        record = WrenchRecord(wrench, self._sequence, status)
        for sent in [record] if self.tamper is None else self.tamper(record):
            drained = 1 if self._record is None else self._record.drained + 1
            self._record = sent._replace(drained=drained)

    def read(self, since: int, timeout: float) -> WrenchRecord | None:
        """Return the record put since the last reading; see `ForceSensorDevice`."""
        del since, timeout
        record, self._record = self._record, None
        return record

    def close(self) -> None:
        """Forget the record."""
        self._record = None
