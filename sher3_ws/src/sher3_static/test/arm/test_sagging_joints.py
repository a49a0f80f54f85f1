"""A joint that gives way under the weight behind it, on arms whose masses the diagnosis does not know."""

import numpy as np
import pytest
from arms import ROWS, X, Z, machine, measured
from sher3_diagnosis import diagnose
from sher3_static.arm.kinematics import postures
from sher3_static.readings import Readings

WEIGHT = np.array([0.0, 0.0, -9.81])


STIFFNESS = {"j2": 2e4, "j3": 2e4, "j5": 5e3}
"""N m/rad: a wrist carries less, on smaller gears."""


def weighed(seed, soft, down=WEIGHT, n=80, noise=5e-5):
    """Poses of an arm of drawn point masses, in the middle of each link and at the flange, one joint a spring.

    The joint's turn is that of the weight in the nominal posture: a second turn of it is a millionth.
    """
    draw = np.random.default_rng(seed)
    arm, q = machine().known.arm, draw.uniform(-1.2, 1.2, (n, len(ROWS)))
    at, j = postures(arm, q), int(soft[1:]) - 1
    points = np.concatenate([at.frames[:, :, :3, 3], at.tip[:, None, :3, 3]], axis=1)
    middles = 0.5 * (points[:, j:-1] + points[:, j + 1 :])
    masses = [*draw.uniform(2.0, 20.0, middles.shape[1]), draw.uniform(5.0, 50.0)]
    torque = np.zeros(n)
    for mass, place in zip(masses, [*np.moveaxis(middles, 1, 0), points[:, -1]], strict=True):
        torque += mass * np.sum(at.axes[:, j] * np.cross(place - points[:, j], down), axis=1)
    turned = q.copy()
    turned[:, j] += torque / STIFFNESS[soft]
    poses = Z @ postures(arm, turned).tip @ X
    poses[:, :3, 3] += noise * draw.normal(size=(n, 3))
    return Readings("run", {"joints": q, "poses": poses})


@pytest.mark.parametrize("soft", STIFFNESS)
@pytest.mark.parametrize("seed", range(3))
def test_the_joint_that_gives_way_is_named(seed, soft):
    """The masses are drawn: where the weight is, the diagnosis has to find for itself."""
    verdict = diagnose(machine(noise=5e-5), [weighed(seed, soft)]).verdict
    first = verdict.causes[0]
    assert (first.effect, first.actuator) == ("joint_sag", soft)
    assert first.parameters["sag"].value > 0.0 and first.parameters["sag"].unit == "rad/m"
    assert verdict.closure.stage.value > 0.9


def test_an_arm_that_hangs_gives_way_in_the_other_sense():
    cause = diagnose(machine(noise=5e-5), [weighed(0, "j2", down=-WEIGHT)]).verdict.causes[0]
    assert (cause.effect, cause.actuator) == ("joint_sag", "j2") and cause.parameters["sag"].value < 0.0


@pytest.mark.parametrize("seed", range(4))
def test_a_zero_that_is_off_gives_way_nowhere(seed):
    offsets = np.array([0.0, 0.004, -0.003, 0.002, 0.0, 0.0])
    causes = diagnose(machine(), [measured(offsets, seed=seed)]).verdict.causes
    assert {c.effect for c in causes} == {"encoder_offset"}
