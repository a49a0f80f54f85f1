"""What the kinds of chains share: how a file becomes runs, and how a case stores one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TypeVar

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.mending.stretches import repeats_judged
from sher3_machines.intake.tables import Tables

from sher3_chain.joint.parts import columns_of, parts_of_record
from sher3_chain.joint.record import AxesRun, ChainDescription, axes_run

D = TypeVar("D", bound=ChainDescription)


class ChainKind(Kind[D, AxesRun]):
    """Chains of joints; a case stores `period` and an array `JOINT/SIGNAL` for each signal."""

    def read(self, name: str, tables: Tables, description: D) -> AxesRun:
        """Bring a data file onto a uniform clock; raises MachineError."""
        return axes_run(name, tables, description)

    def chosen(self, records: Mapping[str, Tables], description: D) -> tuple[Mapping[str, Tables], str]:
        """Return as many repeats as an answer needs; all where they differ in conditions, or are none."""
        if not description.repeats or description.conditions:
            return records, ""
        return repeats_judged(records, len(columns_of(description)))

    def parts(self, name: str, tables: Tables, description: D, records: int = 1) -> tuple[dict[str, Tables], str]:
        """Return the parts of a record with holes, and stretches of a long one; a repeat stays one."""
        return parts_of_record(name, tables, description, records)

    def pack(self, run: AxesRun) -> Mapping[str, Array]:
        """Return the period (1,), s, and every signal (n,) as `JOINT/SIGNAL`, in the units of the description."""
        signals = {f"{joint}/{k}": x for joint, found in run.signals.items() for k, x in found.items()}
        return {"period": np.array([run.period]), **signals}

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> AxesRun:
        """Return the run that a case stores; raises KeyError without a period."""
        signals: dict[str, dict[str, Array]] = {}
        for key, x in arrays.items():
            if key != "period":
                joint, signal = key.rsplit("/", 1)
                signals.setdefault(joint, {})[signal] = x
        return AxesRun(name, float(arrays["period"][0]), signals, notes)
