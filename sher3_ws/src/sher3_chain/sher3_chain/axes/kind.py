"""The kind `axes`: a chain of axes in a case folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.tables import Tables

from sher3_chain.axes.description import AxesDescription
from sher3_chain.axes.machine import Axes
from sher3_chain.axes.record import AxesRun, axes_run, parts_of_record


class AxesKind(Kind[AxesDescription, AxesRun]):
    """Chains of axes; a case stores `period` and an array `AXIS/SIGNAL` for each signal."""

    name = "axes"
    description = AxesDescription

    def read(self, name: str, tables: Tables, description: AxesDescription) -> AxesRun:
        """Bring a data file onto a uniform clock; raises MachineError."""
        return axes_run(name, tables, description)

    def parts(self, name: str, tables: Tables, description: AxesDescription) -> tuple[dict[str, Tables], str]:
        """Return the parts of a record whose clock has holes or jumps back; repeats stay whole."""
        return ({name: tables}, "") if description.repeats else parts_of_record(name, tables, description)

    def pack(self, run: AxesRun) -> Mapping[str, Array]:
        """Return the period and every signal."""
        return packed(run)

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> AxesRun:
        """Return the run that a case stores; raises KeyError without a period."""
        return unpacked(name, arrays, notes)

    def machine(self, description: AxesDescription) -> Axes:
        """Return the chain."""
        return Axes(description)


def packed(run: AxesRun) -> Mapping[str, Array]:
    """Return the arrays of a run as a case stores them: `period` and `AXIS/SIGNAL`."""
    signals = {f"{axis}/{k}": x for axis, found in run.signals.items() for k, x in found.items()}
    return {"period": np.array([run.period]), **signals}


def unpacked(name: str, arrays: Tables, notes: Sequence[str]) -> AxesRun:
    """Return the run that a case stores; raises KeyError without a period."""
    signals: dict[str, dict[str, Array]] = {}
    for key, x in arrays.items():
        if key != "period":
            axis, signal = key.rsplit("/", 1)
            signals.setdefault(axis, {})[signal] = x
    return AxesRun(name, float(arrays["period"][0]), signals, notes)


KIND = AxesKind()
