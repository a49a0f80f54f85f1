"""How long the calibration of a serial arm takes: a seven-joint arm with errors in every joint, seen by a tracker.

    python bench/arm.py [--poses 3000] [--json]

Prints seconds of the processor, one thread, and of the clock, and how many joint zeros were named; the target is 20 s
for 3000 poses.
"""

from __future__ import annotations

import argparse
import json
import time

import numpy as np
from scipy.spatial.transform import Rotation
from sher3_diagnosis import diagnose
from sher3_static.arm.description import Joint
from sher3_static.arm.kind import KIND, KnownArm
from sher3_static.arm.kinematics import Arm, arm_from_table, postures
from sher3_static.arm.sight import PoseSight
from sher3_static.readings import Readings

TARGET = 20.0
"""Seconds for 3000 poses."""
NOISE, NOISE_ROTATION = 5e-5, 2e-4
"""Of a laser tracker's pose [m, rad]."""
TABLE = ((0.0, 0.0, 0.333), (0.0, -1.5708, 0.0), (0.0, 1.5708, 0.316), (0.0825, 1.5708, 0.0),
         (-0.0825, -1.5708, 0.384), (0.0, 1.5708, 0.0), (0.088, 1.5708, 0.0))  # fmt: skip
"""a [m], alpha [rad], d [m] of a seven-joint arm."""


def calibration(poses: int, seed: int = 1) -> tuple[Arm, Readings]:
    """Return the nominal arm and measured poses of one whose zeros and lengths are off by 2 mrad and 0.3 mm."""
    rng = np.random.default_rng(seed)
    nominal = [Joint(name=f"joint_{k + 1}", a=a, alpha=alpha, d=d, offset=0.0) for k, (a, alpha, d) in enumerate(TABLE)]
    real = [
        j.model_copy(update={"offset": 2e-3 * rng.standard_normal(), "d": j.d + 3e-4 * rng.standard_normal()})
        for j in nominal
    ]
    q = rng.uniform(-1.5, 1.5, (poses, len(TABLE)))
    measured = postures(arm_from_table(real, 0.107), q).tip
    measured[:, :3, 3] += NOISE * rng.standard_normal((poses, 3))
    turn = Rotation.from_rotvec(NOISE_ROTATION * rng.standard_normal((poses, 3))).as_matrix()
    measured[:, :3, :3] = measured[:, :3, :3] @ turn
    return arm_from_table(nominal, 0.107), Readings("tracker", {"joints": q, "poses": measured})


def main() -> None:
    """Print the times."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=3000)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    arm, data = calibration(options.poses)
    machine = KIND.knowing(KnownArm(arm, PoseSight(), NOISE, NOISE_ROTATION))
    clock, processor = time.perf_counter(), time.process_time()
    verdict = diagnose(machine, [data]).verdict
    row = {
        "poses": options.poses,
        "processor_s": time.process_time() - processor,
        "clock_s": time.perf_counter() - clock,
        "causes": len(verdict.causes),
        "status": verdict.status,
    }
    print(json.dumps(row) if options.json else ", ".join(f"{k} {v}" for k, v in row.items()))


if __name__ == "__main__":
    main()
