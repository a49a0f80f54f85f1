"""Readers that are native code, which a damaged file can crash: they run in a child, with limits on memory and time."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path

import numpy as np
from sher3_common import read_bytes
from sher3_common.files.arrays import read_arrays
from sher3_diagnosis.channel import Array

MAX_MEMORY = 4_000_000_000
"""Address space of the child, bytes: twice the largest file that is read."""
MAX_SECONDS = 120.0
"""Time the child may take; 2 GB from a slow disk take a minute."""
MAX_BYTES = 2_000_000_000
"""Largest file, and largest arrays of it together, bytes."""
SLASH = "\\"
"""What stands for the slash of a path in a member of an NPZ, where a slash would be a folder."""


def read_in_child(reader: str, raw: bytes) -> dict[str, Array]:
    """Return the arrays that a reader finds in a file.

    Args:
        reader: module of this package with a function `arrays(raw, limit)`, which raises ValueError.
        raw: the file, as `whole` returns it.

    Raises:
        ValueError: the reader refused the file, crashed or took too long.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "arrays.npz"
        command = [sys.executable, "-m", __name__, reader, str(MAX_BYTES), str(out)]
        limits = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
        try:
            done = subprocess.run(
                command, input=raw, env={**os.environ, **limits}, capture_output=True, timeout=MAX_SECONDS, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise ValueError(f"its reader took more than {MAX_SECONDS:g} s") from error
        if done.returncode != 0 or not out.is_file():
            said = done.stderr.decode(errors="replace").strip().splitlines()
            raise ValueError(said[-1] if done.returncode == 1 and said else f"its reader crashed ({done.returncode})")
        return {name.replace(SLASH, "/"): x for name, x in read_arrays(out, max_bytes=MAX_BYTES).items()}


def whole(path: Path) -> bytes:
    """Return a file; raises FileError where it is too large."""
    return read_bytes(path, MAX_BYTES)


def main(reader: str, limit: int, target: str) -> int:
    """Read a file from standard input in this process, with limits, and write its arrays; return the exit code.

    Args:
        reader: module of this package.
        limit: largest arrays together, bytes.
        target: path of the npz file to write.
    """
    import resource

    module = import_module(f"{__package__ or __spec__.parent}.{reader}")
    resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, MAX_MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (MAX_MEMORY, MAX_MEMORY))
    try:
        found = module.arrays(sys.stdin.buffer.read(), limit)
    except Exception as error:  # whatever the reader makes of a bad file: the parent turns it into a typed error
        print(f"{type(error).__name__}: {error}".replace("\n", " ")[:200], file=sys.stderr)
        return 1
    np.savez(target, **{name.replace("/", SLASH): x for name, x in found.items()})  # type: ignore[arg-type]
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), sys.argv[3]))
