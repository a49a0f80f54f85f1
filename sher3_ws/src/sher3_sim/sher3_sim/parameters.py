"""The numbers the compiled plant runs on: one record per axis, one for the rest, and the mechanism's geometry.

Effects write into these before the plant starts; a value of zero means the effect is absent. Rows follow ACTUATORS.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_description import Robot
from sher3_description.contract import EFFORT_NOISE, EFFORT_RESOLUTION, REFERENCE_TEMPERATURE
from sher3_kinematics.kernel import KernelParameters, kernel_parameters

from sher3_sim.found import AXIS_TERMS, BODY_TERMS, ROW

Records = Any
"""A structured array: numpy types none of its fields, so neither does this."""

AXIS = np.dtype(
    [
        # the nominal axis (robot.yaml)
        *((name, "f8") for name in ("kp", "ki", "limit", "mass", "viscous", "lead")),
        *((name, "f8") for name in ("motor_count", "load_count", "velocity_limit", "position_gain")),
        *((name, "f8") for name in ("effort_noise", "effort_count")),
        # transport [s, s, 1]
        *((name, "f8") for name in ("delay", "jitter", "drop")),
        # drive: lag of the force [s], dead zone of the demand [m/s]
        *((name, "f8") for name in ("lag", "deadband", "torque_scale")),
        # friction: levels [N], velocity [m/s], bristle deflection [m], modulation along the lead, decaying part
        *((name, "f8") for name in ("coulomb", "static", "stribeck_velocity", "displacement")),
        *((name, "f8") for name in ("friction_amplitude", "friction_periods", "friction_phase")),
        *((name, "f8") for name in ("friction_decaying", "friction_decay_time")),
        # other forces: cogging [N], extra weight [1], cable [N/m, N, m]
        *((name, "f8") for name in ("cogging_amplitude", "cogging_periods", "cogging_phase")),
        *((name, "f8") for name in ("gravity_scale", "cable_stiffness", "cable_force", "cable_displacement")),
        # transmission
        *((name, "f8") for name in ("lead_error", "ripple_amplitude", "ripple_periods", "ripple_phase")),
        *((name, "f8") for name in ("ripple_base_amplitude", "ripple_base_phase")),
        *((name, "f8") for name in ("backlash", "hysteresis", "hysteresis_displacement", "compliance")),
        # load behind the compliance: its mass [kg], and how it swings [Hz, 1]; 0 Hz: too fast to be seen
        *((name, "f8") for name in ("load_mass", "swing_frequency", "swing_damping")),
        # mechanism: clearance of the leg's joints [m], growth of the slide [1/K]
        *((name, "f8") for name in ("clearance", "expansion")),
        # run-to-run: start against q_ref(0), random force [N] and its correlation time [s]
        *((name, "f8") for name in ("start_offset", "disturbance", "disturbance_time")),
        # sensing
        *((name, "f8") for name in ("encoder_scale", "eccentricity", "eccentricity_phase", "encoder_offset")),
        ("load_zero", "f8"),
        # discovered formulas: rows of numbers, and whether there are any
        ("found_any", "?"),
        ("found", "f8", (AXIS_TERMS, ROW)),
    ]
)

BODY = np.dtype(
    [
        ("period", "f8"),
        ("temperature", "f8"),  # of the structure [degC]
        # structure: scale of the delta's link law and of the lumped model, the lumped model, the tool, one mode
        ("gives_way", "?"),  # any of the following, but for the mode
        ("link_fraction", "f8", 3),
        ("link_difference", "f8", 3),
        ("link_law", "f8"),
        ("link_exponent", "f8"),
        ("link_weight", "f8"),  # of the platform, where the links carry it [N]
        ("platform_balls", "f8", (6, 3)),
        ("lumped_fraction", "f8"),
        ("bending", "f8"),
        ("mode_frequency", "f8"),
        ("mode_damping", "f8"),
        ("mode_gain", "f8", (3, 3)),  # shift per static shift under an acceleration, axes of {b}
        # mechanism, beyond the geometry: growth [1/K] of everything, of the links, of the arm
        ("expansion", "f8"),
        ("link_expansion", "f8"),
        ("arm_expansion", "f8"),
        # force sensor in {f}: matrix on the wrench, bias, drift per K, tool, cable
        ("wrench_matrix", "f8", (6, 6)),
        ("wrench_bias", "f8", 6),
        ("wrench_drift", "f8", 6),
        ("tool_mass", "f8"),
        ("tool_com", "f8", 3),
        ("sensor_position", "f8", 3),
        ("sensor_cable_stiffness", "f8"),
        ("sensor_cable_force", "f8"),
        ("sensor_cable_displacement", "f8"),
        ("wrench_noise", "f8", 6),
        ("wrench_resolution", "f8", 6),
        ("wrench_range", "f8", 6),
        ("tracker_period", "f8"),
        ("tracker_noise", "f8", 2),
        ("found_any", "?"),
        ("found", "f8", (BODY_TERMS, ROW)),
    ]
)


@dataclass
class PlantParameters:
    """Everything the plant needs to know; nominal until effects are applied.

    Attributes:
        robot: The nominal robot, which is what the host believes.
        axis: Records of type AXIS, (5,), SI units.
        body: One record of type BODY, (1,).
        geometry: Geometry of the true mechanism; effects replace values in it.
        substeps: Integration steps per control period.
    """

    robot: Robot
    axis: Records
    body: Records
    geometry: KernelParameters
    substeps: int = 8

    def without_noise(self) -> PlantParameters:
        """Return a copy whose sensors neither scatter nor round: the mean of what the plant does, for fits."""
        quiet = self.copy()
        quiet.axis["effort_noise"] = 0.0
        for name in ("motor_count", "load_count", "effort_count"):
            quiet.axis[name] *= 1e-6
        quiet.body["wrench_noise"], quiet.body["tracker_noise"] = 0.0, 0.0
        quiet.body["wrench_resolution"] *= 1e-6
        return quiet

    def copy(self) -> PlantParameters:
        """Return an independent copy."""
        return copy.copy(self)._with(self.axis.copy(), self.body.copy())

    def _with(self, axis: Records, body: Records) -> PlantParameters:
        self.axis, self.body = axis, body
        return self


def nominal_parameters(robot: Robot) -> PlantParameters:
    """Return the parameters of the contract's nominal model, version 1, section 3."""
    axis = np.zeros(5, AXIS)
    for record, actuator in zip(axis, robot.actuators, strict=True):
        record["kp"], record["ki"] = actuator.drive.kp, actuator.drive.ki
        record["limit"] = actuator.drive.limit
        record["effort_noise"] = EFFORT_NOISE * actuator.drive.rated
        record["effort_count"] = EFFORT_RESOLUTION * actuator.drive.rated
        record["mass"], record["viscous"], record["lead"] = actuator.mass, actuator.viscous, actuator.lead
        record["motor_count"], record["load_count"] = actuator.motor_encoder, actuator.load_encoder
        record["velocity_limit"], record["position_gain"] = actuator.limits.velocity, robot.position_gain
        record["torque_scale"] = 1.0
    return PlantParameters(robot, axis, _nominal_body(robot), kernel_parameters(robot))


def _nominal_body(robot: Robot) -> Records:
    body = np.zeros(1, BODY)
    sensor, record = robot.force_sensor, body[0]
    record["period"] = robot.control_period
    record["temperature"] = REFERENCE_TEMPERATURE
    law = robot.delta.link_compliance
    record["link_law"], record["link_exponent"] = law.a * robot.delta.spring_factor, law.b
    record["platform_balls"] = _platform_balls(robot)
    record["wrench_matrix"] = np.eye(6)
    record["tool_mass"], record["tool_com"], record["sensor_position"] = (
        sensor.tool_mass,
        sensor.tool_com,
        sensor.position,
    )
    record["wrench_noise"] = [sensor.noise_force] * 3 + [sensor.noise_torque] * 3
    record["wrench_resolution"] = [sensor.resolution_force] * 3 + [sensor.resolution_torque] * 3
    record["wrench_range"] = [*sensor.range_force, *sensor.range_torque]
    record["tracker_period"] = 1.0 / robot.tracker.rate
    record["tracker_noise"] = robot.tracker.noise_position, robot.tracker.noise_rotation
    return body


def _platform_balls(robot: Robot) -> NDArray[np.float64]:
    """Return (6, 3), the platform's ball centres [m] from its centre: each leg's pair `leg_width` apart."""
    azimuth = np.repeat(robot.delta.leg_azimuth, 2)
    side = np.tile([-0.5, 0.5], 3) * robot.delta.leg_width
    middle = np.sqrt(robot.delta.platform_radius**2 - side**2)
    x = middle * np.cos(azimuth) - side * np.sin(azimuth)
    y = middle * np.sin(azimuth) + side * np.cos(azimuth)
    return np.column_stack([x, y, np.zeros(6)])
