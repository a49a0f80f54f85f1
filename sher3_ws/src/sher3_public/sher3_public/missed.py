"""Periods that a control loop missed, as a cause: of a data set that the loop itself wrote its clock tells them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Verdict, Where
from sher3_machines.intake.mending.stamps import missing_at

from sher3_public.records import Array

EFFECT, FAMILY, STAGE, PLACE = "dropped_commands", "timing", "transport", "all"
"""Of the cause: a loop that misses a period sends nothing, and the drives hold what they were told before."""


def with_missed(verdict: Verdict, clocks: Sequence[Array]) -> Verdict:
    """Return a verdict with the periods that clocks (n,), s, missed in all runs as its last place and cause.

    Its gap is by how long commands came late, its floor how far the other stamps are off an even clock, rms in s.
    """
    missing = np.concatenate([missing_at(clock) for clock in clocks])
    if not missing.any():
        return verdict
    period = float(np.median(np.concatenate([np.diff(clock) for clock in clocks])))
    uneven = np.concatenate([np.diff(clock) for clock in clocks]) - period * (1 + missing)
    late, floor = (float(np.sqrt(np.mean(x**2))) for x in (period * missing, uneven))
    longest = period * int(missing.max())
    regime = f"at {np.count_nonzero(missing)} of {len(missing)} steps"
    where = Where(
        stage=STAGE, actuator=PLACE, gap=late, floor=floor, unit="s", regime=regime, confidence=1.0
    )  # fmt: skip
    share = float(missing.sum() / (missing.sum() + len(missing)))
    sizes = {"probability": Parameter(value=share, unit="1"), "longest": Parameter(value=longest, unit="s")}
    cause = Cause(
        effect=EFFECT, family=FAMILY, stage=STAGE, actuator=PLACE, parameters=sizes, closure=Interval(value=1.0)
    )  # fmt: skip
    known = {"where": [*verdict.where, where], "causes": [*verdict.causes, cause]}
    return verdict.model_copy(update=known if verdict.where else {**known, "status": "attributed"})
