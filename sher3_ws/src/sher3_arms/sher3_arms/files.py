"""What truth and answer hand each other: a folder with a record, a nominal model and a description."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from sher3_common import dump_yaml

RECORD, MODEL, DESCRIPTION, CASE = "record.npz", "model.urdf", "machine.yaml", "case"
"""Files of a sealed case, and the folder of the imported one."""


def write_case(
    folder: Path,
    urdf: str,
    names: tuple[str, ...],
    arrays: dict[str, np.ndarray],
    count: float,
    noise: np.ndarray,
) -> None:
    """Write a sealed case: names, units and resolutions, nothing of a fault.

    Args:
        folder: new.
        urdf: nominal model.
        names: of the k joints.
        arrays: `time` (n,), s, `position` and `link` (n, k), rad, and `effort` (n, k), N m.
        count: of the encoders, rad.
        noise: (k,) resolution of the efforts, N m.
    """
    joints = [
        {
            "name": name,
            "motion": "rotary",
            "signals": {
                "position": {"column": "position", "unit": "rad", "index": i},
                "effort": {"column": "effort", "unit": "N*m", "index": i},
                "load": {"column": "link", "unit": "rad", "index": i},
            },
            "encoder_resolution": count,
            "effort_resolution": float(noise[i]),
        }
        for i, name in enumerate(names)
    ]
    folder.mkdir(parents=True)
    (folder / MODEL).write_text(urdf, encoding="utf-8")
    np.savez_compressed(folder / RECORD, **arrays)  # type: ignore[arg-type]
    data = {"kind": "manipulator", "name": "arm", "model": MODEL, "time": {"column": "time"}, "joints": joints}
    (folder / DESCRIPTION).write_text(dump_yaml(data), encoding="utf-8")
