"""Limits of a twist and of its change, which keep the direction; and of the rate at which a parameter changes.

The limits of the actuators, and the braking before the ends of travel and workspace, are part of the inverse velocity
in `sher3_kinematics`.
"""

import math

from sher3_common.compiled import compiled
from sher3_common.vectors import Twist


@compiled
def _scale(twist: Twist, linear_limit: float, angular_limit: float) -> float:
    """Return the largest factor up to 1 with which both parts of the twist keep their limits."""
    v = math.sqrt(twist[0] * twist[0] + twist[1] * twist[1] + twist[2] * twist[2])
    w = math.sqrt(twist[3] * twist[3] + twist[4] * twist[4] + twist[5] * twist[5])
    s = 1.0
    if v > linear_limit:
        s = linear_limit / v
    if w * s > angular_limit:
        s = angular_limit / w
    return s


@compiled
def limit_twist(twist: Twist, linear_limit: float, angular_limit: float) -> Twist:
    """Return the twist scaled as a whole, so that both of its norms keep their limits [m/s], [rad/s]."""
    s = _scale(twist, linear_limit, angular_limit)
    return (twist[0] * s, twist[1] * s, twist[2] * s, twist[3] * s, twist[4] * s, twist[5] * s)


@compiled
def limit_change(twist: Twist, previous: Twist, linear_step: float, angular_step: float) -> Twist:
    """Return the twist nearest `twist` on the straight line from `previous` to it, within one step.

    The change keeps both steps, `linear_step` [m/s] and `angular_step` [rad/s].
    """
    change = (
        twist[0] - previous[0],
        twist[1] - previous[1],
        twist[2] - previous[2],
        twist[3] - previous[3],
        twist[4] - previous[4],
        twist[5] - previous[5],
    )
    s = _scale(change, linear_step, angular_step)
    if s == 1.0:
        return twist
    return (
        previous[0] + s * change[0],
        previous[1] + s * change[1],
        previous[2] + s * change[2],
        previous[3] + s * change[3],
        previous[4] + s * change[4],
        previous[5] + s * change[5],
    )


@compiled
def approach(value: float, target: float, rise: float, fall: float) -> float:
    """Return `value` moved towards `target`, up by `rise` or down by `fall` at most; it lands on the target exactly."""
    if target > value + rise:
        return value + rise
    if target < value - fall:
        return value - fall
    return target
