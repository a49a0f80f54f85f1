"""The five axes as one compiled MuJoCo model, and which of its joints is what."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sher3_challenge.plants.mujoco.axes.mjcf import mjcf
from sher3_challenge.plants.mujoco.axes.parts import AXES, ELEMENTS, Array, Axis
from sher3_challenge.plants.mujoco.engine import mujoco


@dataclass
class Machine:
    """The compiled model with what the loop must know of it.

    Attributes:
        model, data: MuJoCo's.
        motor: (5,) degree of freedom of the motor side.
        load_force: (5,) degree of freedom on which the load acts.
        load: (5, nq) load position per joint position, ripple and play behind the encoder left out.
        leg: (5, nq) position behind the encoder, at the mechanism.
        read: (5, nq) what the load encoder sees on top.
        middle: joint between the two springs of a rubber coupling, by axis.
        follows: joints that start where the load is, by axis.
    """

    model: Any
    data: Any
    motor: list[int]
    load_force: list[int]
    load: Array
    leg: Array
    read: Array
    middle: dict[int, int] = field(default_factory=dict)
    follows: list[list[int]] = field(default_factory=list)


def machine(axes: list[Axis], period: float) -> Machine:
    """Compile the axes."""
    model = mujoco.MjModel.from_xml_string(mjcf(axes, period))
    address = {model.joint(i).name: int(model.jnt_qposadr[i]) for i in range(model.njnt)}
    load, leg, read = (np.zeros((AXES, model.nq)) for _ in range(3))
    m = Machine(model, mujoco.MjData(model), [], [], load, leg, read)
    for j, axis in enumerate(axes):
        motor = address[f"m{j}"]
        source = address.get(f"l{j}", motor)
        m.motor.append(motor)
        m.load_force.append(address[f"l{j}"] if axis.heavy else motor)
        load[j, source] = 1.0 if source != motor else 1 + axis.lead_error
        if axis.rubber > 0.0:
            m.middle[j] = address[f"r{j}"]
        if axis.windup > 0.0:
            first = len(axis.bristles)
            for i, (part, reach) in enumerate(ELEMENTS, first):
                slope = part * axis.windup / (reach * axis.windup_reach)
                load[j, motor] -= slope
                load[j, address[f"b{j}_{i}"]] += slope
        leg[j] = load[j]
        if axis.leg_gap > 0.0:
            leg[j, source] -= 1.0
            leg[j, address[f"g{j}"]] += 1.0
        for rider in axis.riders:
            for name, part in rider.read:
                read[j, address[name]] += part
        m.follows.append([a for n, a in address.items() if n in _followers(j, axis)])
    return m


def _followers(j: int, axis: Axis) -> set[str]:
    count = len(axis.bristles) + (len(ELEMENTS) if axis.windup > 0.0 else 0)
    return {f"l{j}", f"r{j}", f"g{j}", *(f"b{j}_{i}" for i in range(count))}
