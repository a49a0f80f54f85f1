"""The seal of a challenge: a manifest of hashes of cases and labels, written before anyone diagnoses."""

from __future__ import annotations

import hashlib
from pathlib import Path

from sher3_common import read_json

from sher3_challenge.errors import ChallengeError

CASES, LABELS, MANIFEST = "cases", "labels", "manifest.json"
MAX_MANIFEST_BYTES = 64 << 20


def hashes(folder: Path, prefix: str = CASES) -> dict[str, str]:
    """Return SHA-256 by file of a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {f"{prefix}/{p.relative_to(folder)}": hashlib.sha256(p.read_bytes()).hexdigest() for p in files}


def check_seal(folder: Path) -> None:
    """Check cases and labels of a finished challenge against its manifest.

    Raises:
        ChallengeError: a file is not what was sealed.
    """
    manifest = read_json(folder / MANIFEST, MAX_MANIFEST_BYTES)
    now = hashes(folder / CASES) | hashes(folder / LABELS, LABELS)
    changed = sorted(key for key in now.keys() | manifest.keys() if now.get(key) != manifest.get(key))
    if changed:
        raise ChallengeError(
            "cases or labels changed after sealing",
            value=", ".join(changed[:3]),
            limit=len(changed),
            remedy="run the challenge again in a new folder",
        )
