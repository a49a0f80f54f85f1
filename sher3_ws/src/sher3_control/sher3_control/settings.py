"""Settings of the control nodes: typed and checked, with units and the reason for each default.

What belongs to the robot (gains, dead bands, cut-off, speed caps of the law) has its default in `robot.yaml`; what
belongs to the software has it here.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sher3_description import Robot

from sher3_control.errors import SettingsError

Number = Annotated[float, Field(allow_inf_nan=False)]
Seconds = Annotated[Number, Field(gt=0.0, le=10.0)]
Fraction = Annotated[Number, Field(ge=0.0, le=1.0)]
Force = Annotated[Number, Field(gt=0.0, le=100.0)]
CUTOFF_SHARE = 0.8
"""Highest cut-off of the low-pass as a share of half the control rate; nearer to it the filter would hardly filter."""


class Settings(BaseModel):
    """Base of every part of the settings: immutable, and unknown names are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class PedalSettings(Settings):
    """How the foot pedal is read.

    Attributes:
        mode: `proportional` scales the velocity with the travel, `binary` switches it on and off.
        release: travel at and below which the pedal is released; also the dead band of the proportional mode [1].
        press: travel from which it is pressed; above `release` by the hysteresis [1].
        age_limit: oldest pedal sample that still counts [s]; an older one is a stop.
    """

    mode: Literal["proportional", "binary"] = "proportional"
    release: Fraction = 0.05
    press: Fraction = 0.10
    age_limit: Seconds = 0.020


class WrenchSettings(Settings):
    """What makes a wrench sample believable.

    Attributes:
        age_limit: oldest wrench sample that still counts [s].
        frozen_samples: this many bit-identical new samples in a row mean that the sensor is frozen [1]. With the
            nominal noise two samples in a row agree in all six axes with probability 3e-4, six in a row with 2e-18.
        saturation: fraction of the sensor's range from which it counts as saturated [1].
    """

    age_limit: Seconds = 0.010
    frozen_samples: Annotated[int, Field(ge=2, le=1000)] = 6
    saturation: Annotated[Number, Field(gt=0.5, le=1.0)] = 0.98


class AdmittanceSettings(Settings):
    """The cooperative law v = gain * pedal * deadband(force).

    Attributes:
        linear_gain, angular_gain: (m/s)/N and (rad/s)/(N m).
        force_deadband, torque_deadband: N and N m, per axis in {t}.
        filter_cutoff: -3 dB frequency of the second-order low-pass [Hz].
        linear_limit, angular_limit: caps of the tip twist [m/s], [rad/s].
        linear_acceleration, angular_acceleration: caps of its change [m/s^2], [rad/s^2]; with the defaults the speed
            caps are reached in 10 ms.
        gain_rate: largest change of a gain, relative to the gain of the settings [1/s]; with 1 it takes a second to
            double it.
        scale_rate: largest rise of the speed scale [1/s]; a fall acts at once.
        gain_maximum: live gains are accepted up to this multiple of the gain of the settings [1].
        joints_age_limit: oldest joint sample from which the frames may be taken [s].
        lead_limit: a tick that runs late finds samples of later ticks; they may be ahead of it by one period and this
            much more [s].
    """

    linear_gain: Annotated[Number, Field(ge=0.0, le=0.05)]
    angular_gain: Annotated[Number, Field(ge=0.0, le=100.0)]
    force_deadband: Annotated[Number, Field(ge=0.0, le=5.0)]
    torque_deadband: Annotated[Number, Field(ge=0.0, le=0.1)]
    filter_cutoff: Annotated[Number, Field(gt=0.1, le=200.0)]
    linear_limit: Annotated[Number, Field(gt=0.0, le=0.05)]
    angular_limit: Annotated[Number, Field(gt=0.0, le=3.0)]
    linear_acceleration: Annotated[Number, Field(gt=0.0, le=10.0)] = 0.5
    angular_acceleration: Annotated[Number, Field(gt=0.0, le=300.0)] = 30.0
    gain_rate: Annotated[Number, Field(gt=0.0, le=100.0)] = 1.0
    scale_rate: Annotated[Number, Field(gt=0.0, le=100.0)] = 2.0
    gain_maximum: Annotated[Number, Field(ge=1.0, le=100.0)] = 5.0
    joints_age_limit: Seconds = 0.020
    lead_limit: Annotated[Number, Field(ge=0.0, le=1.0)] = 0.0


class TareSettings(Settings):
    """When a tare is believable.

    Attributes:
        samples: length of the window [1].
        still: largest joint motion within the window, as a fraction of each axis' travel [1]; the default lets a
            slider move by 4 um.
        noise_factor: largest standard deviation, as a multiple of the sensor's own noise [1].
        residual: largest bias that is accepted, as a fraction of the sensor's range [1].
        drift_force, drift_torque: contact at the tip [N], [N m] of a tool that nobody touches, from which its drift is
            reported and the robot is not enabled: half the dead band of the law, so that what passes moves nothing.
        arming_samples: length of the mean that is judged before the robot is enabled [1]; 0.1 s at 500 Hz, longer than
            a touch in passing and shorter than the way from the tool to the pedal.
    """

    samples: Annotated[int, Field(ge=10, le=10000)] = 250
    still: Annotated[Number, Field(gt=0.0, le=0.01)] = 5e-5
    noise_factor: Annotated[Number, Field(gt=1.0, le=100.0)] = 4.0
    residual: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.2
    drift_force: Annotated[Number, Field(gt=0.0, le=10.0)] = 0.05
    drift_torque: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.001
    arming_samples: Annotated[int, Field(ge=1, le=10000)] = 50


class MotionSettings(Settings):
    """The motion modes of the kinematics node.

    Attributes:
        servo_timeout: a servo mode that gets no newer command for this long ends, and the robot stops [s].
        ahead_limit: how far the stamp of a command may be ahead of its arrival [s].
        joints_age_limit: oldest joint sample from which a command may be computed [s].
        lead_limit: joints and cooperative twist may be ahead of the tick by one period and this much more [s].
        step_factor: largest accepted step of a position reference, as a multiple of limits.velocity / position_gain,
            the step at which the host law saturates [1].
        settle_time: how long a move may settle after its planned motion before the robot is handed back [s].
        settle_factor: a move has settled within this many load-encoder counts of the goal [1].
        speed: fraction of the velocity limits that the move modes use [1].
        acceleration: fraction of the acceleration limits that the move modes use [1].
        ramp_time: time in which that acceleration is built up; it sets the jerk [s].
        linear_speed, angular_speed: caps of the tip for move_cp [m/s], [rad/s].
        rcm_gain: rate at which a deviation from the remote centre decays [1/s].
        rcm_integral: rate at which the hold against a steady push grows [1/s^2]; with `rcm_gain` and the 8 ms of
            transport and drive it leaves a phase margin of 56 degrees.
        regime: speed regime at the start, see `sher3_control.motion.speed_cap`.
        free_speed, free_turning: caps of the tip in the regime `free` [m/s], [rad/s].
        near_speed, near_turning: caps of the tip in the regime `near_tissue` [m/s], [rad/s].
        leg_share: cap of a leg in multiples of the tip's: 2 mm/s near tissue, so that a leg that runs at it moves the
            tip by 40 um at most. Fast turns about a tip far off the centre need more, and are slower.
        tilt_arm: cap of the tilt's slider per rate of turning [m/rad]: 1.05 times the most that a turn needs.
        regime_delay: time that the motor driver has for raising the drives' own limits before a faster regime begins
            [s]: 25 periods at 500 Hz; two SDO transfers a drive take 14 ms.
        free_travel, near_travel: farthest the tip may travel after a fault in each of the two regimes [m]: the
            thickness of a retina, and the error that a needle in it may have.
        deflection_compensation: correct pose commands by the deflection modelled from the measured wrench.
        deflection_cutoff: cut-off of the first-order low-pass on that wrench [Hz]. A hand is slower than 2 Hz, which
            let 0.1 um of the sensor's noise through.
    """

    servo_timeout: Seconds = 0.020
    ahead_limit: Seconds = 1.0
    joints_age_limit: Seconds = 0.010
    lead_limit: Annotated[Number, Field(ge=0.0, le=1.0)] = 0.0
    step_factor: Annotated[Number, Field(gt=0.0, le=10.0)] = 1.0
    settle_time: Seconds = 0.5
    settle_factor: Annotated[Number, Field(ge=1.0, le=1000.0)] = 10.0
    speed: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.5
    acceleration: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.2
    ramp_time: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.020
    linear_speed: Annotated[Number, Field(gt=0.0, le=0.05)] = 0.005
    angular_speed: Annotated[Number, Field(gt=0.0, le=3.0)] = 0.3
    rcm_gain: Annotated[Number, Field(ge=0.0, le=100.0)] = 50.0
    rcm_integral: Annotated[Number, Field(ge=0.0, le=1000.0)] = 500.0
    regime: Literal["near_tissue", "free", "bench"] = "free"
    free_speed: Annotated[Number, Field(gt=0.0, le=0.05)] = 0.005
    free_turning: Annotated[Number, Field(gt=0.0, le=3.0)] = 0.3
    near_speed: Annotated[Number, Field(gt=0.0, le=0.05)] = 0.0005
    near_turning: Annotated[Number, Field(gt=0.0, le=3.0)] = 0.03
    leg_share: Annotated[Number, Field(ge=1.0, le=100.0)] = 4.0
    tilt_arm: Annotated[Number, Field(ge=0.01, le=1.0)] = 0.03
    regime_delay: Seconds = 0.050
    free_travel: Annotated[Number, Field(gt=0.0, le=0.01)] = 250e-6
    near_travel: Annotated[Number, Field(gt=0.0, le=0.01)] = 25e-6
    deflection_compensation: bool = False
    deflection_cutoff: Annotated[Number, Field(gt=0.0, le=50.0)] = 2.0


class SupervisorSettings(Settings):
    """What the supervisor watches.

    Attributes:
        stream_age_limit: a watched stream that is silent for longer is a fault while ENABLED or PAUSED [s]; the law
            itself has stopped long before.
        publish_period: period at which state and status are repeated [s].
        heartbeat_period: period of the supervisor's heartbeat and of its checks [s].
        heartbeat_limit: silence of the supervisor after which law and modes take the robot for not enabled [s].
        overrun_share: share of lost or overrun cycles of a node within a second above which the robot pauses [1].
        leg_distance: motion of one leg's slider, seen by the tracker and not by the load encoders, above which the leg
            has slipped [m]; a push of 1 N bends the structure of the paper by up to 0.35 mm.
        leg_latency: how long that motion must last [s].
        leg_memory: time constant with which slow changes of it are taken for granted [s].
        hand_limits: low passes on the difference of force sensor and drives, each with its time constant [s] and the
            difference that is too much behind it [N]; on the nominal robot healthy running stays
            below four fifths of it.
        hand_share: what they may differ by besides, as a share of the hand that both feel [1].
        hand_astray: difference of a leg's speed from its command [m/s] beyond which nothing is compared.
        hand_blind: how long the law may move the tip while nothing is compared [s]; a hand that hits the tool takes
            66 ms of it.
        hand_apart: how long the axes may move while no tick has all that is compared [s], as when sensor and drives are
            heard by turns: as long as a supervisor may be silent.
        hand_gap: longest time from one tick to the next after which the legs' motion is known [s].
        hand_memory: time constant with which slow changes of it are taken for granted [s].
        hand_settling: how long after enabling all of it is [s]; drives take up a hand of 6 N in half of it.
        hand_level: what may be taken for granted [N]: the weight of 20 g that the robot file does not know, or a sensor
            that drifts by as much after its tare.
        hand_way: low pass on what sensor and drives feel together along one way [s], and the change of it that is too
            much [N]: 3.3 times its noise along z, 24 mN, and eight times that across.
        hand_late: how far apart sensor and drives may feel a hand that comes as a way begins [s]; measured 11 ms.
        hand_arm: lever at which a torque counts as a force [m]: at this arm torques of healthy running come as near to
            the limits as its forces. At 15 mm their noise along one way stopped a healthy robot in half an hour. A
            sensor turned by 20 degrees is noticed after 0.03 mm at 15 mm, 0.09 at 17.5 and 0.16 at 20 (four seeds).
        hand_least: hand that the drives feel for certain behind `hand_notice` [N]: 3.5 times their noise there, and
            below the dead band of the law.
        hand_notice: low pass on what the drives feel of a hand [s].
        hand_travel: farthest that the law may take the tip while the drives feel no hand [m]; a hand that arrives takes
            up to `linear_gain` times `hand_notice` times `hand_least`, 18 um, and one that turns round twice as much.
        hand_reach: height above the tip of the point whose travel by turning is added [m].
    """

    stream_age_limit: Seconds = 0.1
    publish_period: Seconds = 1.0
    heartbeat_period: Seconds = 0.010
    heartbeat_limit: Seconds = 0.030
    overrun_share: Fraction = 0.1
    leg_distance: Annotated[Number, Field(gt=0.0, le=0.01)] = 1e-3
    leg_latency: Seconds = 0.1
    leg_memory: Seconds = 1.0
    hand_limits: Annotated[tuple[tuple[Seconds, Force], ...], Field(min_length=1, max_length=8)] = (
        (0.02, 0.65),
        (0.04, 0.46),
        (0.1, 0.3),
        (0.2, 0.2),
    )
    hand_share: Fraction = 0.12
    hand_astray: Annotated[Number, Field(gt=0.0, le=0.05)] = 5e-4
    hand_blind: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.12
    hand_apart: Seconds = 0.030
    hand_gap: Annotated[Number, Field(ge=1e-3, le=1.0)] = 0.01
    hand_memory: Annotated[Number, Field(ge=1e-2, le=100.0)] = 2.0
    hand_settling: Seconds = 0.36
    hand_level: Force = 0.2
    hand_way: tuple[Seconds, Force] = (0.8, 0.08)
    hand_late: Seconds = 0.016
    hand_arm: Annotated[Number, Field(gt=0.0, le=1.0)] = 0.0175
    hand_least: Force = 0.07
    hand_notice: Seconds = 0.25
    hand_travel: Annotated[Number, Field(gt=0.0, le=0.01)] = 60e-6
    hand_reach: Annotated[Number, Field(ge=0.0, le=1.0)] = 0.02


class ControlSettings(Settings):
    """All settings of the control nodes."""

    admittance: AdmittanceSettings
    pedal: PedalSettings = PedalSettings()
    wrench: WrenchSettings = WrenchSettings()
    tare: TareSettings = TareSettings()
    motion: MotionSettings = MotionSettings()
    supervisor: SupervisorSettings = SupervisorSettings()

    @classmethod
    def from_robot(cls, robot: Robot, overrides: dict[str, Any] | None = None) -> ControlSettings:
        """Build the settings from `robot.yaml` and nested overrides such as `{"pedal": {"mode": "binary"}}`.

        Raises:
            SettingsError: an override is unknown, out of range, or contradicts another setting.
        """
        data = dict(overrides or {})
        admittance = data.pop("admittance", {})
        if not isinstance(admittance, dict):
            raise SettingsError(
                "settings of admittance are no mapping", value=admittance, remedy="give name: value pairs"
            )
        data["admittance"] = {**robot.admittance.model_dump(), **admittance}
        try:
            settings = cls.model_validate(data)
        except ValidationError as error:
            raise _settings_error(error) from error
        settings._check(robot)
        return settings

    def _check(self, robot: Robot) -> None:
        """Refuse settings that contradict each other or the control rate."""
        if self.pedal.press <= self.pedal.release:
            raise SettingsError(
                "pedal.press must lie above pedal.release",
                value=self.pedal.press,
                limit=self.pedal.release,
                remedy="leave a hysteresis between the two",
            )
        two_heartbeats = 2.0 * self.supervisor.heartbeat_period
        if self.supervisor.heartbeat_limit < two_heartbeats:
            raise SettingsError(
                "supervisor.heartbeat_limit [s] trips on one lost heartbeat",
                value=self.supervisor.heartbeat_limit,
                limit=f"at least {two_heartbeats:g}",
                remedy="shorten supervisor.heartbeat_period or widen the limit",
            )
        if self.motion.near_speed > self.motion.free_speed or self.motion.near_turning > self.motion.free_turning:
            raise SettingsError(
                "motion.near_speed and near_turning must not exceed those of the regime free",
                value=(self.motion.near_speed, self.motion.near_turning),
                limit=(self.motion.free_speed, self.motion.free_turning),
                remedy="lower them",
            )
        highest_cutoff = CUTOFF_SHARE * (0.5 / robot.control_period)
        if self.admittance.filter_cutoff >= highest_cutoff:
            raise SettingsError(
                "admittance.filter_cutoff [Hz] is too close to half the control rate",
                value=self.admittance.filter_cutoff,
                limit=highest_cutoff,
                remedy="lower the cut-off or raise the control rate",
            )


def _settings_error(error: ValidationError) -> SettingsError:
    """Return the first objection of a validation as an error of this package."""
    first = error.errors()[0]
    place = ".".join(str(part) for part in first["loc"])
    limit = first.get("ctx")
    text = ", ".join(f"{name} {value}" for name, value in limit.items()) if limit else None
    return SettingsError(
        f"setting {place}: {first['msg']}", value=first["input"], limit=text, remedy="correct the setting"
    )
