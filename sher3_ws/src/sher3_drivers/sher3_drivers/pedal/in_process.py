"""A pedal whose device end is a method call; for stepped tests and runs in one process."""

from __future__ import annotations

from collections.abc import Callable

from sher3_drivers.errors import DeviceMissing
from sher3_drivers.pedal.device import AGE_LIMIT, PedalState, PedalTamper, wired


class InProcessPedal:
    """A pedal whose device end is a method call; for stepped tests and single-process runs.

    Args:
        age_limit: longest silence once something was heard, s; as with `LocalPedal`.
        clock: time in ns; without a clock, silence is allowed.

    Attributes:
        tamper: takes a state and returns those that arrive: none, one or more. The seam for injected faults.
    """

    def __init__(self, age_limit: float = AGE_LIMIT, clock: Callable[[], int] | None = None) -> None:
        self.tamper: PedalTamper | None = None
        self._clock, self._limit_ns, self._heard_at = clock, round(age_limit * 1e9), 0
        self._state: PedalState | None = None
        self._lost: str | None = None

    def put(self, state: PedalState | None) -> None:
        """Be the device: take this state, or be lost (None)."""
        self._lost = "was unplugged" if state is None else None
        if state is None or self.tamper is None:
            self._take(state if state is None else wired(state))
            return
        for sent in self.tamper(wired(state)):
            self._take(sent)

    def _take(self, state: PedalState | None) -> None:
        self._state = state
        self._heard_at = self._clock() if self._clock is not None else 0

    def read(self) -> PedalState | None:
        """Return the present state; see `PedalDevice`."""
        if self._lost is not None:
            raise DeviceMissing("in-process pedal", self._lost, remedy="put a state")
        silence = 0 if self._clock is None or self._state is None else self._clock() - self._heard_at
        if silence > self._limit_ns:
            limit = f"{self._limit_ns * 1e-9:g} s"
            raise DeviceMissing("in-process pedal", "fell silent", value=f"{silence * 1e-9:.3f} s", limit=limit)
        return self._state

    def close(self) -> None:
        """Do nothing."""
