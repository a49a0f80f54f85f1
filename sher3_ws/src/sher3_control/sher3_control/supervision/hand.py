"""Is there a hand where the force sensor says so? What the drives hold is the other witness.

What sensor and drives feel (`felt_twice`) adds up to zero, whoever pushes. So the sum does not change when the hand
does; a sensor that stands, or is scaled, turned, or pushes by itself changes it. Noise does too, and friction: hence
several low passes, the slower the finer, and limits that grow with the hand that both feel. The sum is judged as change
against its own slow mean, that mean as level against zero, and along one way against its begin (`one_way`). Forces,
and torques at an arm, are judged apart.

While a leg strays nothing can be compared so finely. A firm force that its drive holds for long and the sensor does not
feel is no hand all the same: a drive that goes by itself may report the force that would explain it. Where the drives
hold what the sensor does not feel, one of them is not believed, and all lose their power.

A false force below those limits moves the tip while the drives feel nobody: that travel is bounded. So is the time for
which the law moves the tip while nothing can be compared, as beside an encoder that jitters.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled
from sher3_common.reasons import Action, Reason
from sher3_common.stamps import nanoseconds, seconds
from sher3_common.vectors import Vector
from sher3_kinematics import RobotKinematics

from sher3_control.settings import ControlSettings
from sher3_control.supervision.detectors import Finding, PlainDetector
from sher3_control.supervision.felt_twice import AXES, LEGS, FeltTwice, Motion
from sher3_control.supervision.one_way import OneWay

Array = NDArray[np.float64]
CALM = 0.02
"""Time [s] for which nothing counts after a leg strayed from its command: it comes back with kp/ki of its drive."""
FIRM = 2.0
"""Force [N] that the drives feel for certain also while a leg strays: a hand of 5 N that arrives within 34 ms makes
legs stray for 50 ms, in which the law moves the tip by 70 um. No more of it counts, so that it takes five ticks in one
direction: what they hold against an encoder that jitters is more, and goes to and fro."""
TAKES_UP = 0.25
"""Share of the settling time in which drives take up weights and nothing is a hand: four times their kp/ki."""
FELT = 1.5
"""How many times the least hand the drives are taken to feel at most: behind 0.25 s it is forgotten 0.1 s after the
hand has left, in which the law takes the tip by 50 um near tissue. By their noise a hand that stays falls from there
to the least one with 1.75 standard deviations, and the next tick that feels it ends the travel."""
NOWHERE, HOME = np.zeros(6), np.zeros(AXES)
ONLY_FORCE = (1.0, 0.0)
ROUGH = 0.1
"""Low pass [s] on the sum while a leg strays: `FIRM` is passed 75 ms after a drive begins to go at 0.5 mm/s and to
report the force that would explain it, 40 um; a minute of a healthy surgeon came to 0.3 N."""
GROUPS = (LEGS, AXES - LEGS)
"""Numbers of channels of force and of torque."""
TINY, GRIP = 1e-9, 5.0
"""Least size to divide by; and how many times the level a sample may count while all of it is taken for granted: three
times the noise of a tick, and little of the moment in which a hand takes hold."""


def sizes(channels: Array) -> Array:
    """Return the sizes of force and torque (..., 2) of channels (..., 5)."""
    rows = _sizes(channels.reshape(-1, AXES))
    return rows[0] if channels.ndim == 1 else rows


@compiled
def _sizes(channels: Array) -> Array:
    out = np.zeros((len(channels), 2))
    for n in range(len(channels)):
        x, y, z, roll, tilt = channels[n, 0], channels[n, 1], channels[n, 2], channels[n, 3], channels[n, 4]
        out[n] = math.sqrt(x * x + (y * y + z * z)), math.sqrt(roll * roll + tilt * tilt)
    return out


@compiled
def _at_most(limit: float, channels: Array) -> Array:
    """Return channels (5,) whose force and torque are no larger than a limit."""
    force, torque = _sizes(channels.reshape(1, AXES))[0]
    out = np.empty(AXES)
    out[:LEGS] = channels[:LEGS] * min(1.0, limit / max(force, TINY))
    out[LEGS:] = channels[LEGS:] * min(1.0, limit / max(torque, TINY))
    return out


class HandDetector(PlainDetector):
    """Watches the sum of what force sensor and drives feel while the drives have power.

    Args:
        kinematics: of the robot.
        settings: of the supervisor `hand_*`, and the dead bands of the law.
    """

    def __init__(self, kinematics: RobotKinematics, settings: ControlSettings) -> None:
        self._settings, law = settings.supervisor, settings.admittance
        self._twice, self._motion = FeltTwice(kinematics, self._settings.hand_arm), Motion(kinematics)
        self._lag = np.concatenate([np.full(LEGS, self._motion.lag[:LEGS].mean()), self._motion.lag[LEGS:]])
        lags, limits = zip(*self._settings.hand_limits, strict=True)
        self._lags = np.array([*lags, self._settings.hand_memory])[:, None]
        self._limits = np.array([*limits, self._settings.hand_level])[:, None]
        lag, self._way_limit = self._settings.hand_way
        self._way, self._late = OneWay(lag, self._settings.hand_memory), self._settings.hand_late / lag
        self._force_deadband, self._torque_deadband = law.force_deadband, law.torque_deadband
        self._reach = np.repeat((1.0, self._settings.hand_reach), 3)
        self._nothing = self._found = self._worst = Finding(Reason.HAND_DOUBTFUL, 0.0, min(limits), "N", "force sensor")
        self._last = -1
        self.begin()

    def begin(self) -> None:
        """Forget what was felt: the drives have just got their power, or are about to."""
        self._met = -1
        self._forget()

    def _forget(self) -> None:
        self._felt: Array | None = None
        self._since, self._astray, self._begun, self._settled, self._blind = -1, -1, False, False, 0.0
        self._quick, self._slow = np.zeros((len(self._lags) - 1, AXES)), np.zeros(AXES)
        self._sum = np.zeros(AXES)
        self._rough, self._held_more = np.zeros(AXES), np.zeros(2, dtype=bool)
        self._way.begin()
        self._both, self._hand, self._alone = np.zeros((len(self._lags), 2)), np.zeros(AXES), NOWHERE
        self._found = self._worst = self._nothing

    def feed(self, stamp: int, contact: Vector, q: Vector, effort: Vector, command: Vector) -> None:
        """Take the samples of one tick, each later than the one before.

        They count while the legs move as commanded: a leg that does not is another watch's business, and what it takes
        is no hand.

        Args:
            stamp: of the samples [ns].
            contact: wrench at the tip in {t}, without weight of the tool and bias, N and N m.
            q: load encoders (5,), m and rad.
            effort: of the drives (5,), N and N m.
            command: velocities that the axes were told a tick before (5,), m/s and rad/s.
        """
        joints, commands, touch, efforts = map(np.array, (q, command, contact, effort))
        self._met = stamp
        span = seconds(stamp - self._last)
        if not math.isfinite(sum(contact) + sum(effort)):
            self._forget()
            return
        if self._felt is None or not 0.0 < span <= self._settings.hand_gap:
            self._last = stamp
            self._felt = self._twice.channels(joints, touch, efforts)[0]
            self._motion.begin(joints)
            return
        took, astray = self._motion.advance(span, joints, commands)
        felt, held, jacobian = self._twice.channels(joints, touch, efforts - took)
        self._felt = self._felt + np.minimum(1.0, span / self._lag) * (felt - self._felt)
        asks = math.hypot(*contact[:3]) > self._force_deadband or math.hypot(*contact[3:]) > self._torque_deadband
        moved = self._reach * (jacobian @ commands) * span if asks else NOWHERE
        if astray > self._settings.hand_astray:
            self._astray = stamp + nanoseconds(CALM)
        if stamp > self._astray:
            self.follow(stamp, self._felt, held, moved, joints)
        else:
            self._last = stamp
            firm = sizes(held) * ONLY_FORCE > FIRM
            self._stray(self._felt, held, span)
            self._count(_at_most(FIRM, held) * np.repeat(firm, GROUPS), span, moved)
            self._miss(span * bool(moved.any()))
            self._keep()

    def follow(self, stamp: int, felt: Array, held: Array, moved: Array = NOWHERE, joints: Array = HOME) -> None:
        """Take what the sensor feels and the drives hold (5,), N, of the tick `stamp` [ns].

        `moved`: how far the law took the tip (3,) and by turning a point above it (3,) in this tick, m. `joints`: load
        encoders (5,), m and rad.
        """
        total, settings, self._rough = felt + held, self._settings, np.zeros(AXES)
        step, self._last = min(settings.hand_gap, seconds(stamp - self._last)), stamp
        if self._since < 0:
            self._since, self._slow = stamp, total
        begun = seconds(stamp - self._since)
        known, settled = begun - 0.5 * settings.hand_settling, begun >= settings.hand_settling
        self._begun = begun > TAKES_UP * settings.hand_settling
        # The mean of the second half of the settling time, in which a grip counts little, then with a memory.
        size = settings.hand_memory if settled else max(step, known)
        calm = total if settled else _at_most(GRIP * settings.hand_level, total)
        self._slow = self._slow + step / size * (calm - self._slow)
        self._quick = self._quick + np.minimum(1.0, step / self._lags[:-1]) * (total - self._quick)
        self._sum = self._sum + min(1.0, step / self._lags[0, 0]) * (total - self._sum)
        both = np.minimum(sizes(felt), sizes(self._sum - felt))
        self._both = np.maximum(both, np.exp(-step / self._lags) * self._both)
        self._accuse(self._sum, felt)
        if settled:
            self._compare(step, self._way.follow(step, felt, held, joints, bool(moved.any())))
        else:
            self._settle()
        self._count(held, step, moved)
        self._keep()

    def _settle(self) -> None:
        """Judge the sum itself, more coarsely, since no mean of it is known yet: nobody held the tool at enabling."""
        self._quick = self._quick * self._begun
        limits = self._limits[:-1] + self._settings.hand_level + self._settings.hand_share * self._both[:-1]
        self._tell(sizes(self._quick), limits)

    def _compare(self, step: float, along: Array) -> None:
        """Judge the sum as a change against its mean, that mean, and what changed along the way (3, 5)."""
        if not self._settled:
            self._quick, self._settled = np.tile(self._slow, (len(self._quick), 1)), True
        doubt, (strange, hand, came) = sizes(np.vstack([self._quick - self._slow, self._slow])), sizes(along)
        limits = self._limits + self._settings.hand_share * self._both
        way = self._way_limit + self._settings.hand_share * hand + self._late * came
        self._tell(np.vstack([doubt, strange]), np.vstack([limits, way]))
        self._blind = max(0.0, self._blind - step)

    def _count(self, held: Array, step: float, moved: Array) -> None:
        """Add up the travel that the law makes while the drives feel nobody; a hand that they feel ends it.

        Just after enabling they feel weights, and none of it is a hand.
        What they felt counts as little more than the least hand: a firm one is forgotten as soon as a light one.
        """
        settings = self._settings
        hand = self._begun * (self._hand + min(1.0, step / settings.hand_notice) * (-held - self._hand))
        self._hand = _at_most(FELT * settings.hand_least, hand)
        self._alone = NOWHERE if (sizes(hand) > settings.hand_least).any() else self._alone + moved
        travel = float(np.linalg.norm(self._alone.reshape(2, 3), axis=1).sum())
        self._add(1e6 * travel, 1e6 * settings.hand_travel, "um")

    def move(self, stamp: int) -> None:
        """Take note that the axes were told to move at `stamp` [ns], whether that tick could be compared or not."""
        if self._met < 0:
            self._met = stamp
        if (apart := seconds(stamp - self._met)) > self._settings.hand_gap:
            self._add(apart, self._settings.hand_apart, "s")
            self._keep()

    def _stray(self, felt: Array, held: Array, span: float) -> None:
        """Judge coarsely what a straying leg's drive holds and the sensor does not feel."""
        self._rough = self._rough + min(1.0, span / ROUGH) * (felt + held - self._rough)
        self._accuse(self._rough, felt)
        hand = self._settings.hand_share * sizes(felt)
        self._tell(sizes(self._rough)[None] * ONLY_FORCE, FIRM + hand[None])

    def _miss(self, span: float) -> None:
        """Add up for how long the law moves the tip while nothing is compared; as long of comparing makes up for it."""
        self._blind += span
        self._add(self._blind, self._settings.hand_blind, "s")

    def _add(self, value: float, limit: float, unit: str) -> None:
        """Report another quantity where it is nearer its limit."""
        if value / limit > self._found.value / self._found.limit:
            self._found = self._found._replace(value=value, limit=limit, unit=unit, harder=Action.NONE)

    def _accuse(self, total: Array, felt: Array) -> None:
        """Note where the drives hold more than the sensor feels, force or torque: there they may go by themselves."""
        self._held_more = sizes(total - felt) > sizes(felt)

    def _tell(self, doubts: Array, limits: Array) -> None:
        """Report the doubt (n, 2) that is nearest its limit: a force, or a torque back from its arm."""
        row, torque = np.unravel_index(np.argmax(doubts / limits), doubts.shape)
        value, limit = float(doubts[row, torque]), float(limits[row, torque])
        arm, unit = (self._settings.hand_arm, "N m") if torque else (1.0, "N")
        harder = Action.POWER_OFF if self._held_more[torque] else Action.NONE
        self._found = self._found._replace(value=value * arm, limit=limit * arm, unit=unit, harder=harder)

    def _keep(self) -> None:
        """Keep what was furthest beyond its limit since the last check: a supervisor looks at several ticks at once."""
        if not self._found.value * self._worst.limit <= self._worst.value * self._found.limit:
            self._worst = self._found

    def check(self, now: int) -> Finding | None:
        """Object to what was furthest beyond its limit in any tick since the last check."""
        worst, self._worst = self._worst, self._found
        return None if worst.value <= worst.limit else worst

    def look(self, now: int) -> Finding:
        """Return how much of the force nobody holds, or how far it moved the tip."""
        return self._found

    def recover(self, now: int) -> None:
        """Forget the doubt; that the zero is right is for `zero` to say before the robot is enabled again."""
        self.begin()
