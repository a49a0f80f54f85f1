"""How noisy the readings of a joint are, in the units in which the joint is judged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.localise.readings import noise_in
from sher3_diagnosis.verdict import Noise
from sher3_machines.drafting.guesses import count_of

from sher3_chain.joint.description import Axis
from sher3_chain.joint.record import READINGS


def noise_of_joint(joint: Axis, records: Sequence[Mapping[str, Array]]) -> list[Noise]:
    """Return the noise of every reading of a joint that changes.

    A place that is the sum of a speed, or an effort that follows from a law, is no reading.

    Args:
        joint: as described.
        records: signal -> readings (n,), of each record.
    """
    gain, force = joint.effort_as_read
    out = []
    for reading in READINGS:
        scale, unit = (gain, force) if reading == "effort" else (1.0, joint.unit_of_position)
        read = getattr(joint.signals, reading) is not None and not (reading == "position" and joint.summed)
        moving = [scale * found[reading] for found in records if reading in found and np.ptp(found[reading]) > 0.0]
        if read and moving:
            steps = [step for x in moving if (step := count_of(x)) is not None]
            out.append(noise_in(joint.name, reading, unit, moving, max(steps, default=0.0)))
    return out
