"""Closure bars: how much of the gap each cause closes on held-out runs, with 95 % intervals."""

from __future__ import annotations

from sher3_diagnosis.report.drawing import CORRECTED, FLOOR, INK, NOMINAL, TOGETHER, figure, to_svg
from sher3_diagnosis.verdict import Interval, Verdict
from sher3_diagnosis.words import place, share, words

HALF = 0.5
"""Closure at which a dotted line helps the eye."""
RIGHT = 1.12
"""End of the axis: room for the numbers behind the bars."""


def closure_bars(verdict: Verdict, end: str) -> str | None:
    """Return the picture, or None when nothing was closed; `end` names where the whole machine is judged."""
    if not verdict.causes:
        return None
    bars: list[tuple[str, Interval, str]] = [
        (f"{words(c.effect)}, {place(c.actuator)}", c.closure, CORRECTED) for c in verdict.causes
    ]
    if verdict.closure.stage is not None:
        bars.append(("all causes, at the first place", verdict.closure.stage, TOGETHER))
    if verdict.closure.tip is not None:
        bars.append((f"all causes, {end}", verdict.closure.tip, TOGETHER))
    made, (ax,) = figure(1, 0.75 + 0.42 * len(bars), width=7.4)
    for row, (_, closure, color) in enumerate(bars):
        ax.barh(row, max(closure.value, 0.0), height=0.55, color=color, alpha=0.85)
        if closure.low is not None and closure.high is not None:
            ax.plot([closure.low, closure.high], [row, row], color=INK, lw=1.4, marker="|", ms=9)
        ax.text(1.03, row, share(closure.value), va="center", fontsize=9, color=INK)
    ax.axvline(1.0, color=FLOOR, lw=1.0)
    ax.axvline(0.0, color=FLOOR, lw=1.0)
    ax.axvline(HALF, color=NOMINAL, lw=0.8, ls=":")
    ax.set_yticks(range(len(bars)), [b[0] for b in bars])
    ax.set_xlim(min(0.0, *(b[1].low or 0.0 for b in bars)) - 0.01, RIGHT)
    ax.invert_yaxis()
    ax.grid(axis="y", visible=False)
    ax.set_xlabel("closure: share of the gap above the floor that is gone (0 nothing, 1 down to the floor)")
    return to_svg(made, "closure with intervals")
