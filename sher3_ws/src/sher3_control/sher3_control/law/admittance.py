"""The cooperative law v = gain * pedal * deadband(force), as one pure step from (state, input) to (state, output).

One tick does this, in this order:

1. judge the inputs;
2. take the tool's weight and the sensor's bias off the wrench;
3. low-pass the wrench, and move it to the tip;
4. apply dead band, gain, axis lock and speed caps, in {t};
5. turn the twist into {b}, and cap its change since the last tick.

Any objection to an input gives zero velocity in the same tick, with a reason. The law then starts afresh: it moves
again only after the pedal has been released and pressed.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from sher3_common.compiled import compiled
from sher3_common.reasons import Reason
from sher3_common.stamps import NO_STAMP, judge_age
from sher3_common.vectors import ZERO_TWIST, ZERO_WRENCH, Rotation, Twist, Vector3, Wrench

from sher3_control.law.axis_lock import apply_lock
from sher3_control.law.deadband import deadband
from sher3_control.law.limits import approach, limit_change, limit_twist
from sher3_control.law.low_pass import LowPass, low_pass_step
from sher3_control.law.pedal import pedal_factor, pedal_pressed
from sher3_control.law.tool_compensation import contact_wrench, tip_rotation, twist_in_base, wrench_at_tip
from sher3_control.law.wrench_gate import check_wrench, same_wrench

NO_WRENCH: Wrench = (math.nan,) * 6  # type: ignore[assignment]
"""Stands for the wrench until the first sample has come: no comparison takes it for a force."""

check_age = compiled(judge_age)
"""`judge_age` for compiled code. From Python call `judge_age` itself: handing enumerations to compiled code is slow."""


class LawParameters(NamedTuple):
    """Constants of the law in the units of one tick; build them with `law_parameters`.

    Attributes:
        period: of the control loop [ns].
        ahead_limit: how far the stamp of a sample may be ahead of the tick [ns].
        low_pass: filter of the wrench.
        force_deadband, torque_deadband: per axis in {t} [N], [N m].
        linear_limit, angular_limit: caps of the tip twist [m/s], [rad/s].
        linear_step, angular_step: caps of its change in one tick [m/s], [rad/s].
        linear_gain_step, angular_gain_step: caps of a gain's change in one tick [(m/s)/N], [(rad/s)/(N m)].
        scale_step: cap of the speed scale's rise in one tick [1].
        range: of the force sensor [N], [N m].
        saturation: fraction of the range from which the sensor is saturated [1].
        frozen_samples: number of bit-identical new samples in a row that make a frozen sensor [1].
        wrench_age_limit, pedal_age_limit, joints_age_limit: oldest sample that still counts [ns].
        press, release: pedal travel from which it is pressed, and down to which it stays pressed [1].
        binary: the pedal switches the velocity instead of scaling it.
        tool_mass: [kg].
        tool_com: centre of mass of the tool in {f} [m].
        sensor_position: origin of {f} in {t} [m].
    """

    period: int
    ahead_limit: int
    low_pass: LowPass
    force_deadband: float
    torque_deadband: float
    linear_limit: float
    angular_limit: float
    linear_step: float
    angular_step: float
    linear_gain_step: float
    angular_gain_step: float
    scale_step: float
    range: Wrench
    saturation: float
    frozen_samples: int
    wrench_age_limit: int
    pedal_age_limit: int
    joints_age_limit: int
    press: float
    release: float
    binary: bool
    tool_mass: float
    tool_com: Vector3
    sensor_position: Vector3


class LawInput(NamedTuple):
    """Everything one tick depends on.

    Attributes:
        stamp: the tick [ns].
        wrench_stamp, pedal_stamp, joints_stamp: of the newest samples [ns], -1 where none has arrived.
        enabled: the operating state is ENABLED.
        owner: the cooperative mode owns the robot, or nobody does.
        wrench: raw, in {f} (N, N m).
        travel, emergency: `axes[0]` and `buttons[0]` of the pedal.
        roll, tilt: angles of the newest joint sample [rad].
        speed_scale, linear_gain, angular_gain, lock, bias: live parameters, see `LiveParameters`.
    """

    stamp: int
    enabled: bool
    owner: bool
    wrench_stamp: int
    wrench: Wrench
    pedal_stamp: int
    travel: float
    emergency: bool
    joints_stamp: int
    roll: float
    tilt: float
    speed_scale: float
    linear_gain: float
    angular_gain: float
    lock: int
    bias: Wrench


class LawState(NamedTuple):
    """What the law remembers.

    Attributes:
        stamp: of the last tick [ns].
        armed: the pedal was seen released since the last stop.
        pressed: pedal hysteresis.
        s1, s2: the two filter states of each axis [N], [N m].
        velocity: last commanded twist in {b}.
        linear_gain, angular_gain, speed_scale: their values in force, on the way to those of the input.
        wrench_stamp, wrench: last new wrench sample.
        repeats: how many new samples before it were bit-identical to it.
    """

    stamp: int
    armed: bool
    pressed: bool
    s1: Wrench
    s2: Wrench
    velocity: Twist
    linear_gain: float
    angular_gain: float
    speed_scale: float
    wrench_stamp: int
    wrench: Wrench
    repeats: int


class LawOutput(NamedTuple):
    """Result of one tick.

    Attributes:
        twist: commanded tip twist in {b} (m/s, rad/s).
        reason: why it is zero.
        wrench: contact wrench at the tip in {t}, before the filter (N, N m).
    """

    twist: Twist
    reason: Reason
    wrench: Wrench


def initial_state() -> LawState:
    """Return the state of a law that has seen nothing: not armed, at rest."""
    z = ZERO_WRENCH
    return LawState(NO_STAMP, False, False, z, z, ZERO_TWIST, 0.0, 0.0, 0.0, NO_STAMP, NO_WRENCH, 0)


@compiled
def _objection(i: LawInput, previous_stamp: int, repeats: int, p: LawParameters) -> Reason:
    """Return the first objection to motion that holds whatever the travel of the pedal; MOVING when there is none."""
    if previous_stamp >= 0 and not (0 < i.stamp - previous_stamp <= p.wrench_age_limit):
        return Reason.CLOCK
    reason = check_age(
        i.stamp, i.pedal_stamp, p.pedal_age_limit, p.ahead_limit, Reason.PEDAL_MISSING, Reason.PEDAL_STALE
    )
    if reason != Reason.MOVING:
        return reason
    if i.emergency:
        return Reason.EMERGENCY_STOP
    if not (0.0 <= i.travel <= 1.0):
        return Reason.PEDAL_INVALID
    reason = check_age(
        i.stamp, i.wrench_stamp, p.wrench_age_limit, p.ahead_limit, Reason.WRENCH_MISSING, Reason.WRENCH_STALE
    )
    if reason != Reason.MOVING:
        return reason
    reason = check_wrench(i.wrench, p.range, p.saturation)
    if reason != Reason.MOVING:
        return reason
    if repeats + 1 >= p.frozen_samples:
        return Reason.WRENCH_FROZEN
    reason = check_age(
        i.stamp, i.joints_stamp, p.joints_age_limit, p.ahead_limit, Reason.JOINTS_MISSING, Reason.JOINTS_STALE
    )
    if reason != Reason.MOVING:
        return reason
    if not (math.isfinite(i.roll) and math.isfinite(i.tilt)):
        return Reason.JOINTS_NOT_FINITE
    if not i.enabled:
        return Reason.NOT_ENABLED
    if not i.owner:
        return Reason.NOT_OWNER
    return Reason.MOVING


@compiled
def _count_repeats(s: LawState, i: LawInput) -> int:
    """Return how many new samples in a row equal the newest one; seeing one sample in two ticks does not count."""
    if i.wrench_stamp == s.wrench_stamp:
        return s.repeats
    return s.repeats + 1 if same_wrench(i.wrench, s.wrench) else 0


@compiled
def requested_twist(wrench: Wrench, linear: float, angular: float, lock: int, p: LawParameters) -> Twist:
    """Return the capped twist in {t} for a filtered wrench at the tip (N, N m, in {t}).

    `linear` and `angular` are the products of gain, pedal factor and speed scale, in (m/s)/N and (rad/s)/(N m).
    """
    twist = (
        linear * deadband(wrench[0], p.force_deadband),
        linear * deadband(wrench[1], p.force_deadband),
        linear * deadband(wrench[2], p.force_deadband),
        angular * deadband(wrench[3], p.torque_deadband),
        angular * deadband(wrench[4], p.torque_deadband),
        angular * deadband(wrench[5], p.torque_deadband),
    )
    return limit_twist(apply_lock(twist, lock), p.linear_limit, p.angular_limit)


@compiled
def _filter(x: Wrench, s1: Wrench, s2: Wrench, c: LowPass) -> tuple[Wrench, Wrench, Wrench]:
    """Filter each axis of a wrench; return the result and the two new states."""
    y0, a0, b0 = low_pass_step(c, x[0], s1[0], s2[0])
    y1, a1, b1 = low_pass_step(c, x[1], s1[1], s2[1])
    y2, a2, b2 = low_pass_step(c, x[2], s1[2], s2[2])
    y3, a3, b3 = low_pass_step(c, x[3], s1[3], s2[3])
    y4, a4, b4 = low_pass_step(c, x[4], s1[4], s2[4])
    y5, a5, b5 = low_pass_step(c, x[5], s1[5], s2[5])
    return (y0, y1, y2, y3, y4, y5), (a0, a1, a2, a3, a4, a5), (b0, b1, b2, b3, b4, b5)


@compiled
def _stopped(s: LawState, i: LawInput, armed: bool, pressed: bool, repeats: int) -> LawState:
    """Return the state of a law at rest: the filter is empty, and live parameters act at once, since nothing moves."""
    zero, still = ZERO_WRENCH, ZERO_TWIST
    gains = (i.linear_gain, i.angular_gain, i.speed_scale)
    return LawState(
        i.stamp, armed, pressed, zero, zero, still, gains[0], gains[1], gains[2], i.wrench_stamp, i.wrench, repeats
    )


@compiled
def _rotated_contact(i: LawInput, p: LawParameters) -> tuple[Wrench, Rotation]:
    """Return the contact wrench in {f} (N, N m), and the rotation of {f} in {b}."""
    rotation = tip_rotation(i.roll, i.tilt)
    return contact_wrench(i.wrench, rotation, p.tool_mass, p.tool_com, i.bias), rotation


@compiled
def step(s: LawState, i: LawInput, p: LawParameters) -> tuple[LawState, LawOutput]:
    """Run one tick of the law. The same inputs give the same bits, so a recording can be computed again.

    Args:
        s: memory after the last tick.
        i: everything this tick depends on.
        p: constants.

    Returns:
        The memory for the next tick, and the commanded twist with its reason.
    """
    repeats = _count_repeats(s, i)
    contact, rotation = _rotated_contact(i, p)
    at_tip = wrench_at_tip(contact, p.sensor_position)
    reason = _objection(i, s.stamp, repeats, p)
    if reason != Reason.MOVING:
        return _stopped(s, i, False, False, repeats), LawOutput(ZERO_TWIST, reason, at_tip)
    pressed = pedal_pressed(i.travel, s.pressed, p.press, p.release)
    if not pressed:
        return _stopped(s, i, True, False, repeats), LawOutput(ZERO_TWIST, Reason.PEDAL_RELEASED, at_tip)
    if not s.armed:
        return _stopped(s, i, False, True, repeats), LawOutput(ZERO_TWIST, Reason.NOT_REARMED, at_tip)
    filtered, s1, s2 = _filter(contact, s.s1, s.s2, p.low_pass)
    linear = approach(s.linear_gain, i.linear_gain, p.linear_gain_step, p.linear_gain_step)
    angular = approach(s.angular_gain, i.angular_gain, p.angular_gain_step, p.angular_gain_step)
    scale = approach(s.speed_scale, i.speed_scale, p.scale_step, 1.0)
    factor = scale * pedal_factor(i.travel, pressed, p.release, p.binary)
    filtered_at_tip = wrench_at_tip(filtered, p.sensor_position)
    request = requested_twist(filtered_at_tip, linear * factor, angular * factor, i.lock, p)
    velocity = limit_change(twist_in_base(request, rotation), s.velocity, p.linear_step, p.angular_step)
    state = LawState(i.stamp, True, True, s1, s2, velocity, linear, angular, scale, i.wrench_stamp, i.wrench, repeats)
    return state, LawOutput(velocity, Reason.MOVING, at_tip)
