"""The motion of the lumped plant over one excitation: signals for the recorder."""

from __future__ import annotations

import numpy as np
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_gap.excitation import Excitation

from sher3_challenge.plants.lumped import sensing
from sher3_challenge.plants.lumped.loop import Script, run_loop
from sher3_challenge.plants.lumped.parameters import AXES, Array
from sher3_challenge.plants.lumped.rig import Rig
from sher3_challenge.plants.lumped.tip import follow_tip
from sher3_challenge.plants.plant import Plant
from sher3_challenge.plants.recorder import Signals


def signals_of(
    plant: Plant,
    rig: Rig,
    excitation: Excitation,
    temperature: Array,
    rng: np.random.Generator,
) -> Signals:
    """Run the plant over an excitation at the given temperature (n,) [degC]; return what the sensors would see."""
    robot, p = plant.robot, rig.truth
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
        rig.timing.draw(n, period, rng),
        glitches,
        np.where(rng.random(AXES) < 0.5, -1.0, 1.0),
        period,
    )
    course = run_loop(p, rig.foreign, script)
    kelvin = temperature - REFERENCE_TEMPERATURE
    tips, turns = follow_tip(p.geometry, course.load, contact, kelvin, period)
    wrench = sensing.force_sensor(robot, p.sensors, turns, course.load, contact, kelvin)
    tips, wrench = plant.behind(rig.foreign, course.load, course.force, contact, tips, wrench)
    return Signals(
        course.command, course.echo, course.motor_reading, course.load_reading, course.force, wrench,
        tips + p.sensors.tracker_bias, turns, temperature,
    )  # fmt: skip
