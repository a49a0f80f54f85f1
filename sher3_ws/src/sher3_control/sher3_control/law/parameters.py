"""The constants of the cooperative law, from robot and settings: the one place where seconds become ticks."""

from __future__ import annotations

from sher3_common.stamps import nanoseconds
from sher3_description import Robot

from sher3_control.law.admittance import LawParameters
from sher3_control.law.low_pass import design_low_pass
from sher3_control.settings import ControlSettings


def law_parameters(robot: Robot, settings: ControlSettings) -> LawParameters:
    """Return the law's constants for the control period of `robot`."""
    a, period = settings.admittance, robot.control_period
    sensor = robot.force_sensor
    return LawParameters(
        period=nanoseconds(period),
        ahead_limit=nanoseconds(period + a.lead_limit),
        low_pass=design_low_pass(a.filter_cutoff, period),
        force_deadband=a.force_deadband,
        torque_deadband=a.torque_deadband,
        linear_limit=a.linear_limit,
        angular_limit=a.angular_limit,
        linear_step=a.linear_acceleration * period,
        angular_step=a.angular_acceleration * period,
        linear_gain_step=a.linear_gain * a.gain_rate * period,
        angular_gain_step=a.angular_gain * a.gain_rate * period,
        scale_step=a.scale_rate * period,
        range=_six(sensor.range_force + sensor.range_torque),
        saturation=settings.wrench.saturation,
        frozen_samples=settings.wrench.frozen_samples,
        wrench_age_limit=nanoseconds(settings.wrench.age_limit),
        pedal_age_limit=nanoseconds(settings.pedal.age_limit),
        joints_age_limit=nanoseconds(a.joints_age_limit),
        press=settings.pedal.press,
        release=settings.pedal.release,
        binary=settings.pedal.mode == "binary",
        tool_mass=float(sensor.tool_mass),
        tool_com=sensor.tool_com,
        sensor_position=sensor.position,
    )


def _six(values: tuple[float, ...]) -> tuple[float, float, float, float, float, float]:
    a, b, c, d, e, f = (float(value) for value in values)
    return a, b, c, d, e, f
