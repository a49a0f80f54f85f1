"""Counts on the wire and SI units, both ways and exact: one `AxisScale` per actuator, from the robot file.

Velocities are sent in micro-revolutions per minute of the motor (CiA 402-2, object 0x60A9 = 0xFAB44700). One such count
is 3.3e-11 m/s on a 2 mm screw and 1.05e-9 rad/s at the roll output. A signed number of 32 bits reaches 2147 rpm, 1.8 to
5.9 times the velocity limits. Torque is sent in thousandths of the rated torque (object 0x6077).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sher3_description import Actuator

from sher3_drivers.errors import ScaleError

SI_UNIT_VELOCITY = 0xFAB44700
"""Value of object 0x60A9: prefix 10^-6, numerator revolutions, denominator minutes."""

ENCODER_REVOLUTIONS = 100
"""Motor revolutions over which the increments of an encoder are given (objects 0x608F, and 0x60E6 with 0x60EB).

Over a hundred revolutions every encoder of the robot has a whole number of increments.
"""

_SPARE = 0.05
"""What the drive's own position limits leave beyond the ends of travel, as a share of it."""
_INT32 = 2**31 - 1
_WHOLE = 1e-6
"""How far a number of increments or revolutions may be off a whole one and still be taken for it, relative."""


@dataclass(frozen=True)
class AxisScale:
    """Scales of one axis: SI units per count.

    Attributes:
        name: actuator.
        motor_encoder: m or rad per count of the motor encoder.
        load_encoder: m or rad per count of the load encoder.
        velocity: m/s or rad/s per count of target velocity and velocity demand.
        effort: N or N m per count of torque.
        velocity_limit: largest velocity a command may ask, m/s or rad/s.
        motor_increments: motor encoder counts per ENCODER_REVOLUTIONS motor revolutions.
        load_increments: load encoder counts per ENCODER_REVOLUTIONS motor revolutions.
        rated_milli: rated force or torque, mN or mN m.
        max_motor_speed: the drive's own speed limit, rpm: the velocity limit rounded up.
        stop_deceleration: deceleration of a quick stop, rpm/s: the acceleration limit.
        position_limits: lowest and highest position the drive allows, counts of the motor encoder: the ends of travel
            and a twentieth of it more, since the host brakes before them.
        max_torque: largest torque the drive gives, thousandths of the rated one.
        hold: force with which the drive's integral holds the axis against a departure, ki, N/m or N m/rad.
        settling: time in which it does so, kp / ki, s.
        revolute: the axis turns: its unit is rad, not m.
    """

    name: str
    motor_encoder: float
    load_encoder: float
    velocity: float
    effort: float
    velocity_limit: float
    motor_increments: int
    load_increments: int
    rated_milli: int
    max_motor_speed: int
    stop_deceleration: int
    position_limits: tuple[int, int]
    max_torque: int
    hold: float
    settling: float
    revolute: bool = False

    @property
    def unit(self) -> str:
        """Unit of its position: `rad` or `m`."""
        return "rad" if self.revolute else "m"

    @classmethod
    def from_actuator(cls, actuator: Actuator) -> AxisScale:
        """Return the scales of `actuator`.

        Raises:
            ScaleError: an encoder has no whole number of increments per 100 revolutions, or the velocity limit does
                not fit 32 bits.
        """
        rpm = 60.0 / actuator.lead
        spare = _SPARE * (actuator.limits.upper - actuator.limits.lower)
        scale = cls(
            name=actuator.name,
            motor_encoder=actuator.motor_encoder,
            load_encoder=actuator.load_encoder,
            velocity=actuator.lead * 1e-6 / 60.0,
            effort=actuator.drive.rated / 1000.0,
            velocity_limit=actuator.limits.velocity,
            motor_increments=_increments(actuator.name, "motor_encoder", actuator.lead, actuator.motor_encoder),
            load_increments=_increments(actuator.name, "load_encoder", actuator.lead, actuator.load_encoder),
            rated_milli=round(actuator.drive.rated * 1000.0),
            max_motor_speed=math.ceil(actuator.limits.velocity * rpm - _WHOLE),
            stop_deceleration=round(actuator.limits.acceleration * rpm),
            position_limits=(
                math.floor((actuator.limits.lower - spare) / actuator.motor_encoder),
                math.ceil((actuator.limits.upper + spare) / actuator.motor_encoder),
            ),
            max_torque=round(1000.0 * actuator.drive.limit / actuator.drive.rated),
            hold=actuator.drive.ki,
            settling=actuator.drive.kp / actuator.drive.ki,
            revolute=actuator.kind == "revolute",
        )
        largest = scale.velocity * _INT32
        if scale.velocity_limit > largest:
            remedy = "lower the limit or correct the lead"
            raise ScaleError(
                f"{actuator.name}: the velocity limit does not fit the object",
                value=scale.velocity_limit,
                limit=largest,
                remedy=remedy,
            )
        return scale

    def stop_step(self, period: float) -> float:
        """Return what a quick stop takes off the velocity in a period [s], m/s or rad/s."""
        return self.stop_deceleration * 1e6 * self.velocity * period

    def velocity_counts(self, velocity: float) -> int:
        """Return the counts nearest to a velocity, m/s or rad/s.

        Raises:
            ScaleError: it is not finite, or does not fit 32 bits.
        """
        return _counts(self.name, "velocity", velocity, self.velocity)

    def motor_counts(self, position: float) -> int:
        """Return the motor encoder counts nearest to a position, m or rad; raise ScaleError as `velocity_counts`."""
        return _counts(self.name, "motor position", position, self.motor_encoder)


def _counts(axis: str, quantity: str, value: float, resolution: float) -> int:
    """Return a value in counts of `resolution`, whose number has to fit 32 bits."""
    counts = value / resolution
    if not (math.isfinite(counts) and abs(round(counts)) <= _INT32):
        remedy = "send a finite value within the range"
        raise ScaleError(
            f"{axis}: {quantity} does not fit its object", value=value, limit=_INT32 * resolution, remedy=remedy
        )
    return round(counts)


def _increments(axis: str, encoder: str, lead: float, resolution: float) -> int:
    """Return the increments of an encoder over ENCODER_REVOLUTIONS motor revolutions."""
    exact = ENCODER_REVOLUTIONS * lead / resolution
    if not math.isclose(exact, round(exact), rel_tol=_WHOLE):
        remedy = f"give a resolution that divides {ENCODER_REVOLUTIONS} leads"
        raise ScaleError(
            f"{axis}: {encoder} has no whole number of increments per {ENCODER_REVOLUTIONS} revolutions",
            value=exact,
            remedy=remedy,
        )
    return round(exact)
