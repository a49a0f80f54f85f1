"""What a caller states of a table with names, in place of what its columns say."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from sher3_chain.manipulator.bodies import Bodies
from sher3_chain.manipulator.mjcf.drives import Driven
from sher3_machines.drafting.guesses import period_of_log
from sher3_machines.intake.columns import IN_HEADER
from sher3_machines.intake.spelling import bare
from sher3_machines.intake.tables import Tables

from sher3_public.arrays.stating import Stated
from sher3_public.errors import InputError
from sher3_public.records import Arrays

SIGNALS: Mapping[str, str] = {"reference": "control", "command": "control"}
"""Signals that have another name among the arrays."""
BY_NAME = "name the columns as the model names its joints: a table says by that which joint each is"


def check_names(stated: Stated) -> None:
    """Raise InputError where joints or controls are stated: the columns of a table say which they are."""
    if stated.joints or stated.controls:
        raise InputError("joints and controls are stated of arrays", value="a table", remedy=BY_NAME)


def in_si(tables: Sequence[Tables], chain: Mapping[str, Any], stated: Stated) -> list[Tables]:
    """Return tables whose columns are in SI units, as far as units are stated.

    Args:
        tables: of every run.
        chain: draft of the first, by which its columns are known.
        stated: by the caller.

    Raises:
        InputError: a unit is not known, or a column says its own.
    """
    factors = stated.factors()
    scales = {name: factors[array] for name, array in _columns(chain) if array in factors}
    for name in scales:
        if IN_HEADER.fullmatch(name):
            remedy = "take it out of `units`, or rename the column"
            raise InputError("a column says its unit itself", value=name, remedy=remedy)
    return [{n: x * scales.get(n, scales.get(bare(n), 1.0)) for n, x in table.items()} for table in tables]


def drives_of(bodies: Bodies, table: Tables, chain: Mapping[str, Any], stated: Stated) -> Mapping[str, Driven]:
    """Return joint -> its drive, the model's or the servo that is stated; raises InputError for a wrong name."""
    seconds = period_of_log(chain["time"], table) * np.arange(2.0)
    return stated.drives(bodies, list(bodies.joints), Arrays(seconds, np.empty((0, 0))))


def apply_stated(joints: Sequence[dict[str, Any]], stated: Stated, guesses: list[str]) -> None:
    """Write gains, counts and delays that are stated into drafted joints; raises InputError for a wrong name."""
    stated.check_names([joint["name"] for joint in joints])
    for joint in joints:
        gain = stated.gain.get(joint["name"], 1.0) if isinstance(stated.gain, Mapping) else stated.gain
        if gain != 1.0:
            joint["gain"] = gain
        if stated.resolution is not None:
            joint["encoder_resolution"] = stated.resolution
        stated.delayed(joint, guesses)


def _columns(chain: Mapping[str, Any]) -> Iterable[tuple[str, str]]:
    """Yield every column of a draft with the array that it would be."""
    yield str(chain["time"].get("column")), "time"
    for axis in chain["axes"]:
        for signal, column in axis["signals"].items():
            yield column["column"], SIGNALS.get(signal, signal)
