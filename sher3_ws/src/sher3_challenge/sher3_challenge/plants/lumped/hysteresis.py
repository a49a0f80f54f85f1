"""Rate-independent memory as stacks of simple elements (Maxwell slip and Prandtl-Ishlinskii play).

Lampaert, Swevers and Al-Bender (2003) for the Maxwell-slip view of pre-sliding; Krejci (1996) for the play stack.
"""

from __future__ import annotations

import numpy as np

from sher3_challenge.plants.compiled import compiled
from sher3_challenge.plants.lumped.parameters import Array

REACH = np.array([0.25, 0.7, 1.3, 2.2])
"""Break displacements of the elements over the nominal one."""
SHARE = np.array([0.4, 0.3, 0.2, 0.1])
"""Share of each element in the total."""
ELEMENTS = len(REACH)


@compiled
def slip_state(x: float, anchor: Array, reach: float) -> float:
    """Return the normalised state in [-1, 1] of a Maxwell-slip stack (4,) at displacement `x`; anchors stay."""
    z = 0.0
    for i in range(ELEMENTS):
        z += SHARE[i] * min(1.0, max(-1.0, (x - anchor[i]) / (reach * REACH[i])))
    return z


@compiled
def drag_anchors(x: float, anchor: Array, reach: float) -> None:
    """Move the anchors (4,) of the elements that slip, after a step that ended at `x`."""
    for i in range(ELEMENTS):
        width = reach * REACH[i]
        anchor[i] = min(x + width, max(x - width, anchor[i]))


@compiled
def play_offset(x: float, width: float, follower: Array) -> float:
    """Advance a stack (4,) of plays around `width` to input `x`; return output less input.

    Widths spread by +-12 %, so the flanks are soft as those of a real gap are.
    """
    out = 0.0
    for i in range(ELEMENTS):
        half = 0.5 * width * (0.88 + 0.08 * i)
        follower[i] = min(x + half, max(x - half, follower[i]))
        out += follower[i]
    return out / ELEMENTS - x
