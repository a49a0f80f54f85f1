"""Choices among fits that explain equally: decided by a stated rule, never by the rounding of one processor.

Two effects may give the same data (a constant force and one that follows a constant temperature). Their losses then
differ by rounding alone, which depends on the processor and its libraries. A choice by the least loss would too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeVar

T = TypeVar("T")

TIE = 0.01
"""Two held-out losses that differ by less are equal, in squares of the floor: rounding makes 1e-6, and a number must
buy 1200 times this. Set by that argument."""


def first_of_least(values: Mapping[T, float]) -> T:
    """Return the first item whose value is the least, but for a tie: the order of the items decides."""
    least = min(values.values())
    return next(x for x, v in values.items() if v <= least + TIE)


def ranked(items: Sequence[T], value: Callable[[T], float], simplicity: Callable[[T], float]) -> list[T]:
    """Return items with the least value first; of those that tie with the first of them, the simplest first."""
    left = sorted(((value(x), k, x) for k, x in enumerate(items)), key=lambda entry: entry[:2])
    out: list[T] = []
    while left:
        tied = [entry for entry in left if entry[0] <= left[0][0] + TIE]
        left = left[len(tied) :]
        out += [x for _, _, x in sorted(tied, key=lambda entry: (simplicity(entry[2]), entry[1]))]
    return out
