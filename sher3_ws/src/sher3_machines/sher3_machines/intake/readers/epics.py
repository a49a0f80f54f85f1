"""What an EPICS archiver answers as JSON: a list of channels, each with its samples.

The form is that of the retrieval of the EPICS Archiver Appliance (`.json`): `meta` with `name` and `EGU` (the unit),
`data` with `secs`, `nanos` since 1970, `val` and `severity`.
"""

from __future__ import annotations

import numpy as np
from sher3_diagnosis.channel import Array

INVALID = 3
"""Severity of a value that is none: the channel was disconnected, or its record had no valid reading."""


def is_archive(data: object) -> bool:
    """Return whether parsed JSON is the answer of an archiver."""
    return (
        isinstance(data, list)
        and bool(data)
        and all(isinstance(x, dict) and isinstance(x.get("meta"), dict) and _are_samples(x.get("data")) for x in data)
    )


def _are_samples(rows: object) -> bool:
    return isinstance(rows, list) and all(isinstance(row, dict) and {"secs", "val"} <= set(row) for row in rows)


def tables_of_archive(channels: list[dict]) -> dict[str, Array]:
    """Return of each channel `NAME/stamp` (n,), s since 1970, and `NAME/value [UNIT]`, nan where it was not valid.

    Channels whose values are text or arrays of different lengths are left out.
    """
    found: dict[str, Array] = {}
    for channel in channels:
        name, unit = str(channel["meta"].get("name", "channel")).replace("/", "_"), channel["meta"].get("EGU")
        rows = channel["data"]
        try:
            values = np.array([row["val"] for row in rows], dtype=float)
            stamps = np.array([row["secs"] + 1e-9 * row.get("nanos", 0) for row in rows], dtype=float)
        except (TypeError, ValueError):
            continue
        if len(stamps):
            values[[row.get("severity", 0) == INVALID for row in rows]] = np.nan
            found[f"{name}/stamp"], found[f"{name}/value [{unit}]" if unit else f"{name}/value"] = stamps, values
    return found
