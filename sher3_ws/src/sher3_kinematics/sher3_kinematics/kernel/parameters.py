"""The geometry and masses of one robot as a flat tuple of floats that compiled code takes by value.

Every leg has its own numbers, so that a robot that differs from its drawing is the same code with other values:
`parameters._replace(link_1=0.064007)`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray
from sher3_common.compiled import compiled_ieee

if TYPE_CHECKING:
    from sher3_description import Robot


class KernelParameters(NamedTuple):
    """Geometry and masses [m, rad, kg], legs and actuators counted from 1.

    Attributes:
        link_k: link length of leg k.
        anchor_kx, anchor_ky, anchor_kz: base ball pair of leg k at slider height 0, less the platform ball pair in {p}.
        rail_kx, rail_ky: horizontal components of the unit direction of rail k; the third is positive.
        zero_1 ... zero_5: physical coordinate of each actuator when its encoder reads 0 (an encoder that reads
            too much by `offset` has its zero lowered by `offset`).
        base_x, base_y, base_z: rotation vector of the mechanism in {b}.
        d1, d2, d3, tool_x, tool_y, tool_z: arm, as in the robot file.
        crank, coupler, offset: tilt linkage, as in the robot file.
        moving_mass, roll_mass, roll_x, roll_y, roll_z, tilt_mass, tilt_x, tilt_y, tilt_z: masses and their centres.
    """

    link_1: float
    anchor_1x: float
    anchor_1y: float
    anchor_1z: float
    rail_1x: float
    rail_1y: float
    link_2: float
    anchor_2x: float
    anchor_2y: float
    anchor_2z: float
    rail_2x: float
    rail_2y: float
    link_3: float
    anchor_3x: float
    anchor_3y: float
    anchor_3z: float
    rail_3x: float
    rail_3y: float
    zero_1: float
    zero_2: float
    zero_3: float
    zero_4: float
    zero_5: float
    base_x: float
    base_y: float
    base_z: float
    d1: float
    d2: float
    d3: float
    tool_x: float
    tool_y: float
    tool_z: float
    crank: float
    coupler: float
    offset: float
    moving_mass: float
    roll_mass: float
    roll_x: float
    roll_y: float
    roll_z: float
    tilt_mass: float
    tilt_x: float
    tilt_y: float
    tilt_z: float


def kernel_parameters(robot: Robot) -> KernelParameters:
    """Return the kernel parameters of a robot file: equal legs, vertical rails, no base rotation.

    The leg offset R = sqrt(r_b^2 - w^2/4) - sqrt(r_p^2 - w^2/4) follows the recorded-run contract, section 2.
    """
    delta, arm, linkage = robot.delta, robot.arm, robot.tilt_linkage
    legs: list[float] = []
    for azimuth in delta.leg_azimuth:
        x, y = delta.leg_offset * math.cos(azimuth), delta.leg_offset * math.sin(azimuth)
        legs += [delta.link_length, x, y, 0.0, 0.0, 0.0]
    zeros = [delta.slider_zero] * 3 + [0.0, 0.0]
    arm_values = [arm.d1, arm.d2, arm.d3, *arm.tool]
    masses = [delta.moving_mass, arm.roll_mass, *arm.roll_com, arm.tilt_mass, *arm.tilt_com]
    values = [*legs, *zeros, 0.0, 0.0, 0.0, *arm_values, linkage.crank, linkage.coupler, linkage.offset, *masses]
    return KernelParameters(*(float(value) for value in values))


@compiled_ieee(forceinline=True)
def unpack(a: NDArray[np.float64]) -> KernelParameters:
    """Return the parameter tuple held in an array (44,).

    Written out, since the compiler then loads only what is used: 0.45 us less a call than a loop over the members.
    """
    return KernelParameters(
        a[0], a[1], a[2], a[3], a[4], a[5], a[6], a[7], a[8], a[9], a[10],
        a[11], a[12], a[13], a[14], a[15], a[16], a[17], a[18], a[19], a[20], a[21],
        a[22], a[23], a[24], a[25], a[26], a[27], a[28], a[29], a[30], a[31], a[32],
        a[33], a[34], a[35], a[36], a[37], a[38], a[39], a[40], a[41], a[42], a[43],
    )  # fmt: skip
