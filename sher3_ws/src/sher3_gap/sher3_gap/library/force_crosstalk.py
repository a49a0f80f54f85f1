"""Force cross-talk: a load on one axis shows on another."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sher3_gap.channels import Array, Channel
from sher3_gap.library.base import LibraryEffect, Shape, Signature, View


class ForceCrosstalk(LibraryEffect):
    """reading_i += coefficient * wrench_j, i != j: one pair of forces, or all pairs."""

    id, family, stage = "force_crosstalk", "wrench", "sensing"
    explanation = "A force along one axis of the sensor shows up on another axis, in proportion."
    siblings = {"force_scale": "on the same axis", "tool_gravity": "there without a load on the tip"}
    FORCES = tuple((j, i) for j in range(3) for i in range(3) if i != j)
    PAIRS = tuple("xyz"[i] + "xyz"[j] for j, i in FORCES)
    units = {"coefficient": "1", "source": "1", "target": "1", **dict.fromkeys(PAIRS, "1")}

    def sites(self) -> tuple[str, ...]:
        """The force sensor."""
        return ("force_sensor",)

    def channels(self, site: str) -> tuple[Channel, ...]:
        """Seen in the force sensor's reading."""
        return (Channel("sensing", "force_sensor"),)

    def shapes(self, views: Sequence[View], site: str) -> list[Shape]:
        """A pair (source, target), or every pair of forces (-1)."""
        return [{"source": -1.0, "target": -1.0}, *({"source": float(j), "target": float(i)} for j, i in self.FORCES)]

    def signature(self, view: View, site: str, shape: Shape) -> Signature:
        """One column per pair: the source's nominal reading on the target."""
        pairs = self.FORCES if shape["source"] < 0 else ((int(shape["source"]), int(shape["target"])),)
        columns = np.zeros((len(view.run.grid), 6, len(pairs)))
        for k, (j, i) in enumerate(pairs):
            columns[:, i, k] = view.path.nominal_wrench[:, j]
        return Signature({Channel("sensing", site): columns})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Largest coefficient and its pair; where all were free, each: the axis that reads, then the loaded one."""
        k = int(np.argmax(np.abs(coefficients)))
        j, i = self.FORCES[k] if len(coefficients) > 1 else (shape["source"], shape["target"])
        out = {"coefficient": float(coefficients[k]), "source": float(j), "target": float(i)}
        if len(coefficients) > 1:
            out |= {pair: float(c) for pair, c in zip(self.PAIRS, coefficients, strict=True)}
        return out
