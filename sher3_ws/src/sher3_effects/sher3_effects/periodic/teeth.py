"""Teeth that are unlike each other: the orders beside that of their number in what repeats with a revolution."""

from __future__ import annotations

from sher3_diagnosis.effect import Shape


def orders_of(shape: Shape) -> list[float]:
    """Return the orders of a shape, its number of teeth first.

    Teeth that differ over a revolution are a sine whose amplitude goes round, once where the wheel is off its centre,
    twice where it is oval and three times where it sits on three screws: neighbours up to three off show. The shape of
    one tooth is a second and third harmonic.
    """
    n = shape["periods_per_rev"]
    beside = (n - 1.0, n + 1.0, n - 2.0, n + 2.0, n - 3.0, n + 3.0, 2.0 * n, 3.0 * n) if shape.get("unlike") else ()
    return list(dict.fromkeys([n, *(k for k in beside if k > 0.0)]))
