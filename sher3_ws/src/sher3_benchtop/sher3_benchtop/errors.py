"""How a bench-top test can fail."""

from __future__ import annotations

from sher3_bringup.errors import DIED
from sher3_common import Sher3Error


class BenchtopStopped(Sher3Error):
    """The robot did not do as commanded during a bench-top test; carries `test`."""

    exit_code = DIED

    def __init__(self, test: str, why: str) -> None:
        super().__init__(f"{test} stopped: {why}", remedy="look at motion/status and supervisor/status in its bag")
        self.test = test
