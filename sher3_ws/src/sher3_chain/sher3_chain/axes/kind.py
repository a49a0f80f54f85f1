"""The kind `axes`: a chain of axes in a case folder."""

from __future__ import annotations

from sher3_chain.axes.machine import Axes
from sher3_chain.chain.kind import ChainKind
from sher3_chain.joint.description import AxesDescription


class AxesKind(ChainKind[AxesDescription]):
    """Chains of axes."""

    name = "axes"
    description = AxesDescription

    def machine(self, description: AxesDescription) -> Axes:
        """Return the chain."""
        return Axes(description)


KIND = AxesKind()
