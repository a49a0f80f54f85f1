"""What is wrong with an arm: faults by MuJoCo's own means, of a size that the joint's own torque gives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

KINDS = (
    "coulomb",
    "viscous",
    "armature",
    "gain",
    "payload",
    "gear_loss",
    "spring",
    "late_drive",
    "late_effort",
    "backlash",
    "elastic",
)
"""Faults that a library may know: MuJoCo's frictionloss, damping, armature, a gain between recorded and real force, a
body on the last link, a loss in proportion to the drive's force (by callback), stiffness with a spring reference, a
force that acts late, an effort that is recorded late, and a second joint behind the motor's: with a gap between its
stops, or with a spring."""
COMPOUND = "compound"
"""Two of the first faults at once, on different joints."""
BEHIND = ("backlash", "elastic")
"""Faults between the encoder of the motor and that of the link."""
PAIRS = ("coulomb", "viscous", "armature", "gain", "gear_loss", "spring")
"""Faults that a compound case is made of."""
DELAYS = (0.005, 0.02)
"""Shortest and longest delay, s."""
GAPS = (0.002, 0.01)
"""Narrowest and widest gap, rad; a spring gives way by as much under the joint's rms torque."""
OUTSIDE = ("foreign_cable", "stick_at_place", "heavy_air")
"""Faults that none should know, by callback: torque from the position of another joint, a brake within a narrow range
of positions, drag with the cube of speed."""
HEALTHY = "healthy"
CABLE = "cable"
"""Torque over the joint's own position that is no line, by callback; dealt only where it is asked for."""
ORDER = (*KINDS, COMPOUND, COMPOUND, HEALTHY, HEALTHY, HEALTHY, *OUTSIDE, OUTSIDE[0])
"""Kinds of fault as seeds take them in turn: of twenty cases eleven are single, two compound, three healthy, four in no
library."""


@dataclass(frozen=True)
class Fault:
    """One fault of a case.

    Attributes:
        kind: of `KINDS`, `OUTSIDE`, or `HEALTHY`.
        joint: row of the joint; -1 for none.
        size: in the unit of the kind.
        other: further numbers by name.
        second: another fault of a compound case.
    """

    kind: str
    joint: int = -1
    size: float = 0.0
    other: Mapping[str, float] = field(default_factory=dict)
    second: Fault | None = None

    @property
    def parts(self) -> tuple[Fault, ...]:
        """The faults of the case: itself, and the second one."""
        return (self,) if self.second is None else (self, self.second)


def deal(rng: np.random.Generator, kind: str, torque: np.ndarray, speed: np.ndarray, inertia: np.ndarray) -> Fault:
    """Return a fault of a kind on a random joint, sized to 8 to 30 % of that joint's torque.

    Args:
        rng: of the case.
        kind: of fault.
        torque: (k,) rms of each joint in the nominal motion, N m.
        speed: (k,) rms, rad/s.
        inertia: (k,) that each joint moves, kg m^2.
    """
    if kind == HEALTHY:
        return Fault(HEALTHY)
    if kind == COMPOUND:
        first = deal(rng, str(rng.choice(PAIRS)), torque, speed, inertia)
        while (second := deal(rng, str(rng.choice(PAIRS)), torque, speed, inertia)).joint == first.joint:
            pass
        return Fault(first.kind, first.joint, first.size, first.other, second)
    joint = int(rng.integers(len(torque)))
    share = float(np.exp(rng.uniform(np.log(0.08), np.log(0.30))))
    load = share * float(torque[joint])
    sign = float(rng.choice([-1.0, 1.0]))
    if kind == "coulomb":
        return Fault(kind, joint, load)
    if kind == "viscous":
        return Fault(kind, joint, load / float(speed[joint]))
    if kind == "armature":
        return Fault(kind, joint, float(inertia[joint] * rng.uniform(0.3, 1.5)))
    if kind == "gain":
        return Fault(kind, joint, sign * share)
    if kind == "payload":
        reach = rng.uniform(-0.05, 0.1, 3)
        return Fault(
            kind, len(torque) - 1, float(rng.uniform(0.05, 0.2)), dict(zip("xyz", map(float, reach), strict=True))
        )
    if kind == "gear_loss":
        return Fault(kind, joint, share)
    if kind == "spring":
        return Fault(kind, joint, load / 0.5, {"reference": float(rng.uniform(-0.5, 0.5))})
    if kind == CABLE:
        return Fault(kind, joint, 2.0 * load, {"at": float(rng.uniform(-0.3, 0.3))})
    if kind in ("late_drive", "late_effort"):
        return Fault(kind, joint, float(rng.uniform(*DELAYS)))
    if kind in BEHIND:
        give = float(np.exp(rng.uniform(*np.log(GAPS))))
        stiffness = {} if kind == "backlash" else {"stiffness": float(torque[joint]) / give}
        return Fault(kind, joint, give, {"rotor": ROTOR * float(inertia[joint]), **stiffness})
    if kind == "foreign_cable":
        beside = int((joint + 1 + rng.integers(len(torque) - 1)) % len(torque))
        return Fault(kind, joint, 2.0 * load, {"from": float(beside)})
    if kind == "stick_at_place":
        return Fault(kind, joint, 3.0 * load, {"at": float(rng.uniform(-0.3, 0.3))})
    return Fault("heavy_air", joint, 2.0 * load / float(speed[joint]) ** 3)


ROTOR = 0.05
"""Inertia of a motor with a joint of its own, over what the joint moves."""


def passive(fault: Fault, q: np.ndarray, v: np.ndarray, drive: np.ndarray) -> np.ndarray:
    """Return the torque (k,) that a fault by callback adds.

    Args:
        fault: of the case.
        q: (k,) positions, rad.
        v: (k,) velocities, rad/s.
        drive: (k,) torque of the drives, N m.
    """
    out = np.zeros(len(q))
    j = fault.joint
    if fault.kind == "gear_loss":
        out[j] = -fault.size * abs(drive[j]) * np.tanh(v[j] / 1e-3)
    elif fault.kind == "foreign_cable":
        out[j] = -fault.size * np.tanh(3.0 * q[int(fault.other["from"])])
    elif fault.kind == "stick_at_place":
        out[j] = -fault.size * np.exp(-(((q[j] - fault.other["at"]) / 0.1) ** 2)) * np.tanh(v[j] / 1e-2)
    elif fault.kind == CABLE:
        out[j] = -fault.size * (q[j] - fault.other["at"]) ** 2
    elif fault.kind == "heavy_air":
        out[j] = -fault.size * v[j] ** 3
    return out
