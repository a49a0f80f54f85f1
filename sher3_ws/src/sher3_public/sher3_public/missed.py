"""Periods that a control loop missed, as a cause: of a data set that the loop itself wrote its clock tells them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.verdict import Cause, Interval, Parameter, Verdict, Where
from sher3_effects import computed
from sher3_machines.intake.mending.stamps import missing_at

from sher3_public.records import Array

SHARE, PLACE = "probability", "all"
"""What is computed of the cause, and where it acts: a loop that misses a period sends nothing to any joint, and the
drives hold what they were told before."""


def with_missed(verdict: Verdict, clocks: Sequence[Array]) -> Verdict:
    """Return a verdict with the periods that clocks (n,), s, missed in all runs as its last place and cause.

    Its gap is by how long commands came late, its floor how far the other stamps are off an even clock, rms in s.
    """
    missing = np.concatenate([missing_at(clock) for clock in clocks])
    if not missing.any():
        return verdict
    page, steps = computed(SHARE), np.concatenate([np.diff(clock) for clock in clocks])
    period = float(np.median(steps))
    uneven = steps - period * (1 + missing)
    late, floor = (float(np.sqrt(np.mean(x**2))) for x in (period * missing, uneven))
    share = float(missing.sum() / (missing.sum() + len(missing)))
    longest = Parameter(value=period * int(missing.max()), unit="s")
    where = Where(
        stage=page.stage,
        actuator=PLACE,
        gap=late,
        floor=floor,
        unit=longest.unit,
        regime=f"at {np.count_nonzero(missing)} of {len(missing)} steps",
        confidence=1.0,
    )
    cause = Cause(
        effect=page.id,
        family=page.family,
        stage=page.stage,
        actuator=PLACE,
        parameters={SHARE: Parameter(value=share, unit="1"), "longest": longest},
        closure=Interval(value=1.0),
    )
    known = {"where": [*verdict.where, where], "causes": [*verdict.causes, cause]}
    return verdict.model_copy(update=known if verdict.where else {**known, "status": "attributed"})
