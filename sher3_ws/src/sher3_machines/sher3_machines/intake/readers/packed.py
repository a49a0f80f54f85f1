"""Packed files, gzip and zip: what lies in them is read as if it lay in a folder."""

from __future__ import annotations

import gzip
import zipfile
import zlib
from io import BytesIO
from pathlib import Path

from sher3_common import read_bytes

from sher3_machines.errors import MachineError

ENDINGS = (".gz", ".zip")
STEP = 1 << 20
"""Bytes that are unpacked at a time while they are counted."""


def unpack(path: Path, folder: Path, limit: int) -> Path:
    """Write what a packed file holds into a folder; return the file, or the folder where there are several.

    Args:
        path: of the packed file.
        folder: an empty one.
        limit: largest size unpacked, bytes.

    Raises:
        MachineError: it holds nothing, unpacks to too much, or is damaged.
    """
    try:
        _unpack_gzip(path, folder, limit) if path.suffix.lower() == ".gz" else _unpack_zip(path, folder, limit)
    except (OSError, EOFError, zlib.error, zipfile.BadZipFile, RuntimeError, NotImplementedError) as error:
        value = f"{type(error).__name__}: {error}"[:200]
        raise MachineError(f"{path}: cannot be unpacked", value=value, remedy="pack it again") from error
    inside = [x for x in folder.rglob("*") if x.is_file()]
    if not inside:
        raise MachineError(f"{path}: holds no file", remedy="pack the record again")
    return inside[0] if len(inside) == 1 else _deepest(folder)


def _unpack_gzip(path: Path, folder: Path, limit: int) -> None:
    content = bytearray()
    with gzip.GzipFile(fileobj=BytesIO(read_bytes(path, limit))) as source:
        while block := source.read(STEP):
            content += block
            _require_below(limit, len(content), path)
    (folder / path.stem).write_bytes(content)


def _unpack_zip(path: Path, folder: Path, limit: int) -> None:
    """Unpack the members; their names cannot lead out of the folder (`ZipFile.extract`), their sizes are checked."""
    with zipfile.ZipFile(BytesIO(read_bytes(path, limit))) as archive:
        members = [
            x for x in archive.infolist() if not x.is_dir() and not Path(x.filename).name.startswith((".", "__"))
        ]
        _require_below(limit, sum(x.file_size for x in members), path)
        for member in members:
            if not member.filename.startswith("__MACOSX"):
                archive.extract(member, folder)


def _require_below(limit: int, size: int, path: Path) -> None:
    if size > limit:
        raise MachineError(f"{path}: unpacks to too much [bytes]", value=size, limit=limit, remedy="cut the record")


def _deepest(folder: Path) -> Path:
    """Return the folder below which files part: archives often hold one folder."""
    while len(inside := list(folder.iterdir())) == 1 and inside[0].is_dir():
        folder = inside[0]
    return folder
