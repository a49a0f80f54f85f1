"""A multinomial logistic model as plain numbers, small enough to be read."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydantic import BaseModel, ConfigDict, model_validator


class Logistic(BaseModel):
    """Probabilities of a few classes from named numbers.

    Attributes:
        classes: names of the k classes.
        inputs: names of the p numbers that are read.
        middle, spread: (p,) by which they are centred and scaled.
        weights: (k, p) per class; `offset`: (k,).
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    classes: tuple[str, ...]
    inputs: tuple[str, ...]
    middle: tuple[float, ...]
    spread: tuple[float, ...]
    weights: tuple[tuple[float, ...], ...]
    offset: tuple[float, ...]

    @model_validator(mode="after")
    def _require_one_size(self) -> Logistic:
        widths = {len(self.inputs), len(self.middle), len(self.spread), *map(len, self.weights)}
        if len(widths) > 1 or not len(self.classes) == len(self.weights) == len(self.offset):
            raise ValueError("classes, inputs and weights of a logistic model differ in number")
        return self

    def scaled(self, numbers: Mapping[str, float]) -> np.ndarray:
        """Return (p,) the inputs centred and scaled; NaN of a number that is not there."""
        return (np.array([numbers.get(name, np.nan) for name in self.inputs]) - self.middle) / self.spread

    def probabilities(self, numbers: Mapping[str, float], trust: float = 1.0) -> dict[str, float]:
        """Return class -> probability; they add up to one. A number that is not there counts as its middle.

        Args:
            numbers: input -> value.
            trust: factor on the scores, so that with less of it odds are more even, in the same order.
        """
        score = trust * (np.array(self.weights) @ np.nan_to_num(self.scaled(numbers)) + self.offset)
        share = np.exp(score - score.max())
        return dict(zip(self.classes, (share / share.sum()).tolist(), strict=True))
