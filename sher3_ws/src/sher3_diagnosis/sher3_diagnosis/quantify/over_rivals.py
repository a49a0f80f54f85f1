"""Sizes beside a cause that has rivals: what another explanation would leave of them is in their intervals, too.

Of a late command and a rotor that explain as much, each leaves another friction beside it. The interval of a fit is
that of its own causes; which of them is at work, the data do not say.
"""

from __future__ import annotations

from collections.abc import Mapping

from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.verdict import Parameter

LEAST = 1e-3
"""Share of its value to which a size is told at least: beyond that it is told as unknown, not as nothing."""


def over_rivals(found: Attribution, index: int, own: Mapping[str, Parameter]) -> dict[str, Parameter]:
    """Return the parameters of a cause with intervals that hold their values beside each rival of another cause.

    Args:
        found: causes and their rivals.
        index: of the cause.
        own: its parameters beside the causes that were chosen.
    """
    out, term = dict(own), found.fit.terms[index]
    beside = [f for i in found.causes if i != index for f in found.rivals[i]]
    for other in beside:
        at = next((k for k, t in enumerate(other.terms) if t.key == term.key), None)
        if at is not None:
            values = term.effect.parameters(other.terms[at].shape, other.of(at))
            out |= {name: _holding(out[name], own[name], x) for name, x in values.items() if name in own}
    return out


def _holding(p: Parameter, own: Parameter, value: float) -> Parameter:
    """Return a parameter whose interval holds another value with the doubt of its own; its sign stays."""
    if p.low is None or p.high is None or own.low is None or own.high is None:
        return p
    low, high = min(p.low, value - (own.value - own.low)), max(p.high, value + (own.high - own.value))
    if own.low > 0.0:
        low = max(low, LEAST * own.low)
    if own.high < 0.0:
        high = min(high, LEAST * own.high)
    return p.model_copy(update={"low": low, "high": high})
