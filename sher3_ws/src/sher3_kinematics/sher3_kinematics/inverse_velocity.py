"""Actuator velocities for a commanded tip twist, within velocity, acceleration, travel and workspace limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from sher3_common.compiled import compiled_ieee, direct
from sher3_description import ACTUATORS

from sher3_kinematics.arrays import Floats, unpack, vector
from sher3_kinematics.errors import BadInput
from sher3_kinematics.kernel import velocity as codes
from sher3_kinematics.robot_kinematics import RobotKinematics

REACTION_PERIODS = 3.0
"""Control periods from a reading to the effect of the command computed from it: one for transport, one for the drive,
one in reserve."""
REACH_MARGIN = 1.1
"""Least leg elevation that a commanded motion may reach, as a multiple of the least elevation of the workspace."""


class LimitedVelocity(NamedTuple):
    """A velocity that all limits permit.

    Attributes:
        q_dot: Actuator velocities (5,) [m/s, rad/s].
        scale: Factor 0 to 1 by which velocity and braking limits scale the commanded velocity; its direction is kept.
        limited_by: What limits, as in `velocity of roll`, `travel of delta_1`, `reach of delta_2`, `acceleration`;
            empty when nothing does.
    """

    q_dot: Floats
    scale: float
    limited_by: str


class InverseVelocity:
    """Inverse velocity of one robot with its limits; a pure function of its arguments, it keeps no state.

    Attributes:
        limits: rows lower, upper, velocity, acceleration (4, 5).
        period: control period [s].
        reaction: time [s] that passes before a command acts.
    """

    def __init__(
        self,
        kinematics: RobotKinematics,
        period: float | None = None,
        margin: float = 0.0,
        reaction_periods: float = REACTION_PERIODS,
    ) -> None:
        """Take limits from the kinematics; `margin` [m or rad] is kept free at each end of travel.

        Each end is drawn in further by the distance an actuator covers while it reacts: at that moment it may be faster
        than `previous` says, because it has been braking.
        """
        self.period = kinematics.robot.control_period if period is None else period
        if not self.period > 0.0 or not margin >= 0.0:
            raise BadInput(
                "period and margin", value=(self.period, margin), limit="> 0 and >= 0", remedy="correct them"
            )
        self.reaction = max(reaction_periods, 1.0) * self.period
        wait = self.reaction - self.period
        clear = margin + 0.5 * kinematics.acceleration * wait * max(wait - self.period, 0.0)
        lower, upper = kinematics.lower + clear, kinematics.upper - clear
        self.limits = np.array([lower, upper, kinematics.velocity, kinematics.acceleration])
        self._elevation = REACH_MARGIN * kinematics.delta.least_elevation
        self._values = np.array(kinematics.parameters)
        self._constants = (self.limits, self._elevation, self.period, self.reaction)
        rest, still = (0.0,) * 5, (0.0,) * 6
        self._finite = direct(_limited_inverse, self._values, rest, still, rest, *self._constants)

    def of_finite(
        self, q: tuple[float, ...], twist: tuple[float, ...], previous: tuple[float, ...]
    ) -> tuple[tuple[float, ...], float, int]:
        """Return q_dot, scale and limit code (see `describe`) for tuples of finite numbers.

        The control loop calls this: it has judged its inputs already, and the checks of `__call__` would make 12 us of
        2 us.
        """
        return self._finite(self._values, q, twist, previous, *self._constants)

    def __call__(
        self, q: Sequence[float] | Floats, twist: Sequence[float] | Floats, previous: Sequence[float] | Floats
    ) -> LimitedVelocity:
        """Return the permitted actuator velocity for a tip twist.

        Args:
            q: actuator positions (5,).
            twist: commanded tip twist (6,) in {b}, linear [m/s] then angular [rad/s].
            previous: actuator velocity (5,) commanded one period ago.
        """
        state = vector(q, 5, "actuator positions")
        wanted = twist_inverse(self._values, state, vector(twist, 6, "twist"))
        return self._limited(state, wanted, vector(previous, 5, "previous velocity"))

    def limit(
        self, q: Sequence[float] | Floats, wanted: Sequence[float] | Floats, previous: Sequence[float] | Floats
    ) -> LimitedVelocity:
        """Return the permitted part of a wanted actuator velocity (5,); arguments as in the call."""
        state, velocity = vector(q, 5, "actuator positions"), vector(wanted, 5, "wanted velocity")
        return self._limited(state, velocity, vector(previous, 5, "previous velocity"))

    def _limited(self, q: Floats, wanted: Floats, previous: Floats) -> LimitedVelocity:
        q_dot, scale, code = _limit(
            self._values, q, wanted, previous, self.limits, self._elevation, self.period, self.reaction
        )
        return LimitedVelocity(q_dot, scale, describe(code))


def describe(code: int) -> str:
    """Return the text for a limit code of `kernel.velocity`."""
    if code in (codes.FREE, codes.NOT_FINITE, codes.ACCELERATION):
        return ("", "a value that is not finite", "acceleration")[code]
    kind = {1: "velocity", 2: "travel", 3: "reach"}[code // 10]
    return f"{kind} of {ACTUATORS[code % 10]}"


@compiled_ieee
def twist_inverse(parameters: Floats, q: Floats, twist: Floats) -> Floats:
    """Return the actuator velocities (5,) that make a twist (6,) of the tip at q, without any limit."""
    q_dot = np.empty(5)
    codes.twist_inverse_into(unpack(parameters), q, twist, q_dot)
    return q_dot


@compiled_ieee
def _limit(
    parameters: Floats,
    q: Floats,
    wanted: Floats,
    previous: Floats,
    limits: Floats,
    elevation: float,
    period: float,
    reaction: float,
) -> tuple[Floats, float, int]:
    q_dot = np.empty(5)
    p = unpack(parameters)
    scale, code = codes.limit_velocity_into(p, q, wanted, previous, limits, elevation, period, reaction, q_dot)
    return q_dot, scale, code


@compiled_ieee
def _limited_inverse(
    parameters: Floats,
    q: tuple[float, ...],
    twist: tuple[float, ...],
    previous: tuple[float, ...],
    limits: Floats,
    elevation: float,
    period: float,
    reaction: float,
) -> tuple[tuple[float, ...], float, int]:
    state, wanted, q_dot = np.array(q), np.empty(5), np.empty(5)
    p = unpack(parameters)
    codes.twist_inverse_into(p, state, np.array(twist), wanted)
    scale, code = codes.limit_velocity_into(
        p, state, wanted, np.array(previous), limits, elevation, period, reaction, q_dot
    )
    return (q_dot[0], q_dot[1], q_dot[2], q_dot[3], q_dot[4]), scale, code
