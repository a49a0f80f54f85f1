"""How a request for a fault can fail."""

from __future__ import annotations

from typing import Any

from sher3_common import Sher3Error


class FaultRefused(Sher3Error):
    """A fault that cannot be injected; carries `component` and `fault`."""

    exit_code = 2

    def __init__(self, component: str, fault: str, why: str, **details: Any) -> None:
        super().__init__(f"fault {fault} of {component} refused: {why}", **details)
        self.component = component
        self.fault = fault
