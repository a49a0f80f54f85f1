"""HDF5 files, MATLAB's version 7.3 among them: no reader of them is among the dependencies, so they are refused."""

from __future__ import annotations

from pathlib import Path

from sher3_diagnosis.channel import Array

from sher3_machines.errors import MachineError

MAGIC = b"\x89HDF\r\n\x1a\n"
"""How HDF5 files begin; behind 512 bytes of a header those of MATLAB."""
ENDINGS = (".h5", ".hdf5", ".hdf", ".he5", ".h5df")
CONVERTS = (
    "import h5py, numpy as np, sys; d = {}; h5py.File(sys.argv[1]).visititems(lambda n, x: "
    "d.update({n.replace('/', '_'): x[()]}) if isinstance(x, h5py.Dataset) and x.dtype.kind in 'biuf' else None); "
    "np.savez(sys.argv[2], **d)"
)
"""Python that writes every numeric dataset of a file into an NPZ; it needs h5py."""


def refuse_hdf5(path: Path) -> dict[str, Array]:
    """Refuse a file; raises MachineError with how to convert it."""
    raise refused(path, "HDF5", "")


def refused(path: Path, kind: str, first: str) -> MachineError:
    """Return the refusal of a file.

    Args:
        path: of the file.
        kind: of file, in words.
        first: remedy that comes before the conversion.
    """
    command = f'python -c "{CONVERTS}" {path.name} {path.stem}.npz'
    return MachineError(
        f"{path}: {kind} is not read",
        value=path.suffix,
        limit="csv, mat to version 7, npz, json, parquet, bags",
        remedy=f"{first}convert it where h5py is installed: {command}",
    )
