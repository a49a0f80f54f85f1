"""The wrench gate of the law: which samples of the force sensor it believes.

Finite, within the rated range and not saturated is judged here. The age of a sample is judged by
`sher3_common.stamps.judge_age`, a frozen sensor by the law, which remembers the sample before. The health of the sensor
itself is judged by its driver (`sher3_drivers.sensor.health`), with wider limits: a false objection costs a pause here,
and there it would call a good sensor defective.
"""

import math

from sher3_common.compiled import compiled
from sher3_common.reasons import Reason
from sher3_common.vectors import Wrench


@compiled
def same_wrench(a: Wrench, b: Wrench) -> bool:
    """Return whether two finite wrenches agree in all six axes."""
    return a[0] == b[0] and a[1] == b[1] and a[2] == b[2] and a[3] == b[3] and a[4] == b[4] and a[5] == b[5]


@compiled
def check_wrench(wrench: Wrench, limit: Wrench, saturation: float) -> Reason:
    """Return why the numbers of a sample are not believed, MOVING when they are.

    Args:
        wrench: raw sample in {f} [N], [N m].
        limit: range of the sensor, per axis [N], [N m].
        saturation: fraction of the range from which the sensor is saturated [1].
    """
    saturated = False
    for i in range(6):
        x = abs(wrench[i])
        if not math.isfinite(x):
            return Reason.WRENCH_NOT_FINITE
    for i in range(6):
        x = abs(wrench[i])
        if x > limit[i]:
            return Reason.WRENCH_OUT_OF_RANGE
        if x >= saturation * limit[i]:
            saturated = True
    return Reason.WRENCH_SATURATED if saturated else Reason.MOVING
