"""Diagnosis of a gap between a machine and its model: one engine for every machine.

A `Machine` turns runs into `Evidence`; `diagnose(machine, runs)` says in which `Channel` the machine leaves its model,
which `Effect` causes it and how far the gap shrinks, as a `Verdict`.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_diagnosis.channel import Channel as Channel
    from sher3_diagnosis.channel import Residual as Residual
    from sher3_diagnosis.effect import Effect as Effect
    from sher3_diagnosis.effect import Signature as Signature
    from sher3_diagnosis.evidence import Evidence as Evidence
    from sher3_diagnosis.flow import diagnose as diagnose
    from sher3_diagnosis.machine import Diagnosis as Diagnosis
    from sher3_diagnosis.machine import Machine as Machine
    from sher3_diagnosis.verdict import Verdict as Verdict

__getattr__, __dir__ = lazy(
    __name__,
    {
        "channel": ("Channel", "Residual"),
        "effect": ("Effect", "Signature"),
        "evidence": ("Evidence",),
        "flow": ("diagnose",),
        "machine": ("Diagnosis", "Machine"),
        "verdict": ("Verdict",),
    },
)
