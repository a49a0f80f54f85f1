"""A term of a controller that nobody stated: a constant, an integral, or a feed-forward of the reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Shape, Signature, column

from sher3_effects.page import Page
from sher3_effects.view import LawView


class UnstatedTerm(Page):
    """command = law + constant, + gain * integral of the error, or + gain * speed or acceleration of the reference.

    A sign is physical: a feed-forward may be set against the motion by mistake, and a constant is a weight either way.
    """

    id, family, stage = "unstated_term", "scale", "controller"
    kinds = ("law",)
    inputs = ("command", "time")
    best = Best("sweep", "several speeds tell a feed-forward from an integral and both from a gain")
    explanation = "The command holds a term that the stated law does not have."
    siblings = {"controller_gain": "in proportion to a part of the stated law"}
    units = {"constant": "1", "integral_gain": "1/(m s)", "speed_gain": "s/m", "acceleration_gain": "s2/m"}
    discrete = frozenset({"term"})
    TERMS = ("constant", "integral_gain", "speed_gain", "acceleration_gain")
    """Names of the terms, in the order of the shape `term`."""

    def shapes(self, views: Sequence[LawView], site: str) -> list[Shape]:
        """Return which term is there; an integral only where the law has none."""
        integral = any(v.stated.parts[:, 2].any() for v in views)
        return [{"term": float(k)} for k, name in enumerate(self.TERMS) if not (integral and name == "integral_gain")]

    def signature(self, view: LawView, site: str, shape: Shape) -> Signature:
        """Return one column: the term; of an integral another one, since nobody knows where it began."""
        run, error = view.run, view.stated.error
        speed = np.gradient(run.filtered(run.reference)[:, 0], run.period)
        one = np.ones_like(error)
        of_term = ([one], [np.cumsum(error) * run.period, one], [speed], [np.gradient(speed, run.period)])
        parts = [run.to_grid(x[:, None])[:, 0] for x in of_term[int(shape["term"])]]
        return Signature({Channel(self.stage, site): column(*parts)})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the size of the term, the first of (p,), in units of the command."""
        return {self.TERMS[int(shape["term"])]: float(coefficients[0])}
