"""Reference scale: under a loop of the speed an axis goes faster, or slower, than it is asked, by one share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import ClassVar

from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.view import AxisView


class ReferenceScale(Page):
    """speed = (1 + relative) * asked speed, and so the sums of both: error = -relative * asked place.

    Of a servo that is asked for a place a weight at an arm leaves much the same; it has no such page.
    """

    id, family, stage = "reference_scale", "scale", "motor_mechanics"
    kinds, needs, plain = ("servo",), ("asked speed",), True
    inputs = ("command",)
    gives = ("relative",)
    best = Best("steps", "several speeds, in both directions, separate a share from a limit and from friction")
    explanation = (
        "The axis goes too fast or too slowly by one share of what it is asked: counts of another turn, a gear that "
        "nobody stated, or a loop without an integral part, which stays behind."
    )
    siblings = {
        "speed_limit": "slow references are reached, and only fast ones are not",
        "drive_lag": "a steady speed is reached",
    }
    units: ClassVar[Mapping[str, str]] = {"relative": "1"}
    LEAST, LARGEST = 0.005, 0.5
    """Shares between which it is an error of a scale: below are what counts and clocks round, above another unit, or an
    axis that does not follow."""

    def signature(self, view: AxisView, site: str, shape: Shape) -> Signature:
        """Return one column: minus the reference."""
        reference = view.run.reference
        assert reference is not None
        asked = view.run.to_grid(reference[:, [view.row(site)]])
        return Signature({Channel(self.stage, site): column(-asked[:, 0])})

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        """Return whether the share (1,) is more than rounding, and the axis still follows what it is asked."""
        return bool(self.LEAST < abs(coefficients[0]) < self.LARGEST)

    def shapes(self, views: Sequence[AxisView], site: str) -> list[Shape]:
        """Return one shape without a choice, where a reference was recorded."""
        return [{}] if all(v.run.reference is not None for v in views) else []
