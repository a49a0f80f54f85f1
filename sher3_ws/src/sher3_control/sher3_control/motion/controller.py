"""All motion modes together: commands come in, one mode owns the robot, one actuator velocity per tick goes out."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from sher3_common.reasons import Reason
from sher3_common.stamps import judge_age, nanoseconds
from sher3_common.vectors import Vector
from sher3_description import Robot
from sher3_kinematics import RobotKinematics

from sher3_control.errors import CommandRejected
from sher3_control.law.position_controller import position_command
from sher3_control.motion.commands import PoseCommand
from sher3_control.motion.cooperative import RESTING, VelocityModes
from sher3_control.motion.deflection import DeflectionCompensation
from sher3_control.motion.modes import MotionMode, Step
from sher3_control.motion.ownership import Mode, Ownership
from sher3_control.motion.planned.move_modes import MoveJoints, MoveTip
from sher3_control.motion.pose import tool_axis
from sher3_control.motion.servo_modes import ServoJointVelocity, ServoPose, ServoPosition, ServoTwist
from sher3_control.motion.speed_cap import Regime, axis_caps, speed_cap
from sher3_control.settings import MotionSettings

POSE_MODES = (Mode.SERVO_CP, Mode.MOVE_CP)
"""Modes whose commands are tip poses, which the deflection compensation may correct."""


class MotionInput(NamedTuple):
    """Everything one tick depends on besides the queued commands.

    Attributes:
        stamp: the tick [ns].
        enabled: the operating state is ENABLED.
        joints_stamp, q: stamp [ns] and positions (5,) of the newest load-encoder sample; stamp -1 without one.
        twist_stamp, twist: stamp [ns] and twist (6,) in {b} of the newest `servo_cv`; stamp -1 without one.
    """

    stamp: int
    enabled: bool
    joints_stamp: int
    q: Vector
    twist_stamp: int
    twist: Vector


class MotionOutput(NamedTuple):
    """Result of one tick.

    Attributes:
        velocity: commanded actuator velocity (5,).
        setpoint: reference positions (5,) and velocities (5,) of a position mode, None in other modes.
        reason: why there is no motion.
        limited_by: what limits the velocity, see `sher3_kinematics.InverseVelocity`; empty for nothing.
        deviation: distance of the shaft from the remote centre [m], 0 without one.
    """

    velocity: Vector
    setpoint: tuple[Vector, Vector] | None
    reason: Reason
    limited_by: str = ""
    deviation: float = 0.0


class MotionController:
    """All motion modes of the robot.

    Args:
        robot: for kinematics, limits, gain and period.
        settings: of the motion modes.
        compensation: corrects pose commands by the deflection of the structure, or None.

    Attributes:
        ownership: who commands the robot.
        velocity_modes: tip twists and actuator velocities, and the remote centre.
        previous: velocity commanded last (5,).
        regime: speed regime in force; change it with `set_regime`.
    """

    def __init__(
        self, robot: Robot, settings: MotionSettings, compensation: DeflectionCompensation | None = None
    ) -> None:
        kinematics = RobotKinematics(robot)
        self._compensation = compensation
        self.ownership = Ownership()
        self.velocity_modes = VelocityModes(kinematics, settings.rcm_gain, settings.rcm_integral)
        self.previous: Vector = RESTING
        self.regime = Regime(settings.regime)
        self._rearm = True
        self._gain = robot.position_gain
        self._limits = tuple(a.limits.velocity for a in robot.actuators)
        self._age_limit = nanoseconds(settings.joints_age_limit)
        self._lead_limit = nanoseconds(robot.control_period + settings.lead_limit)
        self._kinematics = kinematics
        self._settings = settings
        self._moves = (MoveJoints(robot, kinematics, settings), MoveTip(robot, kinematics, settings))
        self._modes: dict[Mode, MotionMode] = {
            Mode.SERVO_JP: ServoPosition(robot, settings),
            Mode.SERVO_CP: ServoPose(robot, settings, self._inverse),
            Mode.SERVO_JV: ServoJointVelocity(settings),
            Mode.SERVO_CV: ServoTwist(settings),
            Mode.MOVE_JP: self._moves[0],
            Mode.MOVE_CP: self._moves[1],
        }
        self.set_regime(self.regime)

    def set_regime(self, regime: Regime) -> None:
        """Change the speed regime; its caps act from the next tick on, and on moves planned after it."""
        self.regime = regime
        cap = speed_cap(self._settings, regime)
        caps = axis_caps(self._settings, cap, self._limits)
        self.velocity_modes.cap, self.velocity_modes.axis_caps = cap, caps
        for move in self._moves:
            move.cap, move.axis_caps = cap, np.array(caps)

    def _inverse(self, pose: PoseCommand) -> Vector:
        return tuple(self._kinematics.inverse(pose.position, tool_axis(pose.orientation)).tolist())

    def warm_up(self) -> None:
        """Run every compiled part once, so that none compiles during a tick."""
        position_command(RESTING, RESTING, RESTING, self._gain, self._limits)
        self.velocity_modes.warm_up()

    @property
    def busy(self) -> bool:
        """Whether a move is going on (CRTK `is_busy`)."""
        owner = self.ownership.owner
        return owner in self._modes and self._modes[owner].busy

    def command(self, mode: Mode, sample: Any, state: MotionInput, publishers: int = 1) -> None:
        """Take a user's command; nothing changes when it is refused.

        Args:
            mode: the motion mode it is for.
            sample: what that mode's `accept` takes.
            state: time and state of the robot at its arrival.
            publishers: number of publishers of the command's topic.

        Raises:
            CommandRejected: not enabled, another owner, no joint positions, or the mode's own reason.
            Sher3Error: the goal is out of reach (errors of the kinematics).
        """
        if not state.enabled:
            raise CommandRejected(mode.value, "the operating state is not ENABLED", remedy="send enable first")
        reason = self._check_joints(state)
        if reason is not Reason.MOVING:
            raise CommandRejected(mode.value, f"no joint positions ({reason.name})", remedy="check the drives")
        self.ownership.require_free(mode, publishers)
        if self._compensation is not None and mode in POSE_MODES:
            sample = self._compensation.corrected(mode.value, sample, state.stamp, state.q)
        self._modes[mode].accept(sample, state.stamp, state.q)
        self.ownership.claim(mode, state.stamp)

    def cooperative_wants(self, wants: bool, now: int) -> None:
        """Give the free robot to the cooperative mode while the law wants to move, and take it back afterwards.

        After a stop the law must have been seen at rest first: the pedal is released, then pressed.

        Args:
            wants: the cooperative law moves, with the robot enabled.
            now: [ns].
        """
        owner = self.ownership.owner
        self._rearm = self._rearm and wants
        if wants and owner is None and not self._rearm:
            self.ownership.claim(Mode.COOPERATIVE, now)
        elif not wants and owner is Mode.COOPERATIVE:
            self.ownership.release(now)

    def tick(self, i: MotionInput) -> MotionOutput:
        """Run one tick. Any objection means zero velocity at once, and ends the mode that owns the robot."""
        reason = Reason.MOVING if i.enabled else Reason.NOT_ENABLED
        if reason is Reason.MOVING:
            reason = self._check_joints(i)
        if reason is not Reason.MOVING:
            return self._stop(i.stamp, reason)
        owner = self.ownership.owner
        if owner is None or owner is Mode.COOPERATIVE:
            return self._cooperate(i)
        step = self._modes[owner].step(i.stamp, i.q)
        if step.reason is not Reason.MOVING:
            return self._stop(i.stamp, step.reason)
        output = self._carry_out(step, i)
        if output.reason is not Reason.MOVING:
            return self._stop(i.stamp, output.reason, output.deviation)
        if step.finished:
            self.ownership.release(i.stamp)
        self.previous = output.velocity
        return output

    def _check_joints(self, i: MotionInput) -> Reason:
        reason = judge_age(
            i.stamp, i.joints_stamp, self._age_limit, self._lead_limit, Reason.JOINTS_MISSING, Reason.JOINTS_STALE
        )
        if reason is Reason.MOVING and not (len(i.q) == 5 and math.isfinite(sum(i.q))):
            return Reason.JOINTS_NOT_FINITE
        return reason

    def _cooperate(self, i: MotionInput) -> MotionOutput:
        missing, stale = Reason.COMMAND_MISSING, Reason.COMMAND_STALE
        reason = judge_age(i.stamp, i.twist_stamp, self._age_limit, self._lead_limit, missing, stale)
        if reason is Reason.MOVING and self._rearm:
            reason = Reason.NOT_REARMED
        if reason is not Reason.MOVING:
            return self._stop(i.stamp, reason)
        result = self.velocity_modes.from_twist(i.q, i.twist, self.previous)
        if result.reason is not Reason.MOVING:
            return self._stop(i.stamp, result.reason, result.deviation)
        self.previous = result.velocity
        return MotionOutput(result.velocity, None, result.reason, result.limited_by, result.deviation)

    def _carry_out(self, step: Step, i: MotionInput) -> MotionOutput:
        """Return the actuator velocity for what a mode wants, within limits and speed caps."""
        if step.setpoint is not None:
            q_ref, qd_ref = step.setpoint
            velocity = position_command(q_ref, qd_ref, i.q, self._gain, self._limits)
            if self.velocity_modes.cap_factor(i.q, velocity) < 1.0:
                return MotionOutput(RESTING, None, Reason.TIP_SPEED)
            return MotionOutput(velocity, step.setpoint, Reason.MOVING)
        if step.joints is not None:
            result = self.velocity_modes.from_joints(i.q, step.joints, self.previous)
        elif step.twist is not None:
            result = self.velocity_modes.from_twist(i.q, step.twist, self.previous)
        else:
            return MotionOutput(RESTING, None, Reason.MOVING)
        return MotionOutput(result.velocity, None, result.reason, result.limited_by, result.deviation)

    def _stop(self, now: int, reason: Reason, deviation: float = 0.0) -> MotionOutput:
        owner = self.ownership.owner
        if owner in self._modes:
            self._modes[owner].reset()
        # When the robot is not enabled, the law disarms itself. After any other stop this class waits for the release.
        self._rearm = self._rearm or reason is not Reason.NOT_ENABLED
        self.ownership.release(now)
        self.previous = RESTING
        return MotionOutput(RESTING, None, reason, "", deviation)
