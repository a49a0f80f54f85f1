"""A draw in words, as the tables of the search print it, and a draw from words, to be tried again.

near_tissue | idle | tilt.power creep speed 0.0003 at 0; axes.load_encoder stuck at 12

Commas do as well as bars.
"""

from __future__ import annotations

import re

from sher3_common import Sher3Error
from sher3_control.motion.speed_cap import Regime

from sher3_safety.search.draw import DRAWN, STATES, WHOLE, Draw, Fault, Shape

_FAULT = re.compile(r"(\S+) (\S+)(?: (\S+) (\S+))? at (\d+)")
"""Component, kind, name and value of the size where there is one, onset in ticks."""


class NotADraw(Sher3Error):
    """Words that are no draw."""

    exit_code = 2

    def __init__(self, text: str) -> None:
        super().__init__(f"no draw: {text!r}", remedy="copy a line of a table of the search: regime, state, faults")


def read(text: str) -> Draw:
    """Return the draw of a line `regime | state | faults`, or of a whole line of a table.

    Raises:
        NotADraw: it is none.
    """
    try:
        where, state, faults = [part.strip() for part in re.split("[|,]", text.strip(" |\n"))[:3]]
        regime = Regime(where)
        (kept,) = [known for known in STATES[regime] if known.name == state]
        return Draw(tuple([_fault(fault.strip(), regime) for fault in faults.split(";")]), kept, regime)
    except (ValueError, KeyError, AttributeError) as error:
        raise NotADraw(text) from error


def _fault(text: str, regime: Regime) -> Fault:
    match = _FAULT.fullmatch(text)
    if match is None:
        raise ValueError(text)
    component, kind, name, value, onset = match.groups()
    part = component if component in [shape.part for shape in WHOLE] else component.partition(".")[2]
    if name in DRAWN:
        shape = Shape(part, kind, name)
        return Fault(component, shape, float(value) / Fault(component, shape, 1.0, 0).full(regime), int(onset))
    return Fault(component, Shape(part, kind, name or "", float(value or 0.0)), 1.0, int(onset))
