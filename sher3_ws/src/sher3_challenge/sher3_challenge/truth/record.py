"""A recorded run of the truth plant, in the form of the contract."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sher3_bags import Run, Stream, stream
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_gap.excitation import Excitation

from sher3_challenge.oracle import nominal
from sher3_challenge.truth import sensing
from sher3_challenge.truth.loop import Course, Script, run_loop
from sher3_challenge.truth.parameters import AXES, Array, TruthParameters
from sher3_challenge.truth.tip import follow_tip


@dataclass(frozen=True)
class Timing:
    """Transport of commands: fixed delay per axis [s], spread of a random one [s], probability of loss."""

    delay: Array = field(default_factory=lambda: np.zeros(AXES))
    jitter: float = 0.0
    loss: float = 0.0

    def draw(self, ticks: int, period: float, rng: np.random.Generator) -> Array:
        """Return (ticks, 5) delays from tick to arrival; inf where the command is lost. Commands never overtake."""
        common = np.minimum(np.abs(self.jitter * rng.standard_normal(ticks)), 5 * period)
        arrival = np.arange(ticks)[:, None] * period + common[:, None] + self.delay
        arrival = np.maximum.accumulate(arrival, axis=0) - np.arange(ticks)[:, None] * period
        arrival[rng.random(ticks) < self.loss] = np.inf
        arrival[0] = np.where(np.isinf(arrival[0]), 0.0, arrival[0])
        return np.asarray(arrival)


@dataclass(frozen=True)
class Condition:
    """What a run happens under: start of the clock, temperature course, a tracker or none, sensors without noise."""

    stamp: int
    temperature: Callable[[Array], Array]
    tracker: bool = True
    ideal: bool = False


def record(
    robot: Robot,
    p: TruthParameters,
    timing: Timing,
    excitation: Excitation,
    repeat: int,
    condition: Condition,
    seed: int,
) -> Run:
    """Run the truth plant over an excitation and return the recorded run; `seed` fixes every random number in it."""
    rng = np.random.default_rng(seed)
    noise = 0.0 if condition.ideal else 1.0
    n, period = len(excitation.position), robot.control_period
    contact = np.ascontiguousarray(excitation.contact_wrench()[:, :3], dtype=np.float64)
    glitches: Array = (
        p.host.glitch * (rng.random((n, AXES)) < p.host.glitch_probability) * rng.choice([-1.0, 1.0], (n, AXES))
    )
    glitches[:5] = 0.0
    script = Script(
        np.ascontiguousarray(excitation.position),
        np.ascontiguousarray(excitation.velocity),
        contact,
        timing.draw(n, period, rng),
        glitches,
        np.where(rng.random(AXES) < 0.5, -1.0, 1.0),
        period,
    )
    course = run_loop(p, script)
    temperature = condition.temperature(excitation.time)
    kelvin = temperature - REFERENCE_TEMPERATURE
    tips, turns = follow_tip(p.geometry, course.load, contact, kelvin, period)
    wrench = sensing.force_sensor(robot, p.sensors, turns, course.load, contact, kelvin, rng, noise)
    stamps = condition.stamp + np.arange(n) * round(period * 1e9)
    streams = _joint_streams(robot, excitation, course, sensing.effort(robot, course.force, rng, noise), stamps)
    streams["force/measured_cf"] = stream("force/measured_cf", stamps, force=wrench[:, :3], torque=wrench[:, 3:])
    streams["pedal/measured"] = stream("pedal/measured", stamps, axes=np.zeros((n, 1)), buttons=np.zeros((n, 1)))
    every = round(1.0 / period)
    read = temperature[::every] + 0.02 * noise * rng.standard_normal(len(temperature[::every]))
    streams["temperature"] = stream("temperature", stamps[::every], temperature=read)
    if condition.tracker:
        watch = slice(None, None, round(1 / (robot.tracker.rate * period)))
        position, orientation = sensing.tracker(robot, p.sensors, tips[watch], turns[watch], rng, noise)
        streams["tracker/measured_cp"] = stream(
            "tracker/measured_cp", stamps[watch], position=position, orientation=orientation
        )
    return Run(streams, excitation.metadata(repeat, seed=seed), _robot_text(robot))


@lru_cache(maxsize=8)
def _robot_text(robot: Robot) -> str:
    return robot.to_yaml()


def _joint_streams(
    robot: Robot, e: Excitation, course: Course, effort: Array, stamps: NDArray[np.integer[Any]]
) -> dict[str, Stream]:
    velocity = np.zeros_like(course.motor_reading)
    velocity[1:] = np.diff(course.motor_reading, axis=0) / robot.control_period
    tip, rotation = nominal.tip_pose(robot, course.load_reading)
    return {
        "setpoint_js": stream("setpoint_js", stamps, position=e.position, velocity=e.velocity),
        "servo_jv": stream("servo_jv", stamps, velocity=course.command),
        "drives/setpoint_jv": stream("drives/setpoint_jv", stamps, velocity=course.echo),
        "drives/measured_js": stream(
            "drives/measured_js", stamps, position=course.motor_reading, velocity=velocity, effort=effort
        ),
        "measured_js": stream("measured_js", stamps, position=course.load_reading),
        "measured_cp": stream("measured_cp", stamps, position=tip, orientation=rotation.as_quat()),
    }
