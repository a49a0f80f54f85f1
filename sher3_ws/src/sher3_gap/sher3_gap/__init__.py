"""The SHER as a machine of the diagnosis: its cases, stages, floors and simulator."""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_gap.errors import CaseError as CaseError
    from sher3_gap.evidence import SherEvidence as SherEvidence
    from sher3_gap.sher import Sher as Sher
    from sher3_gap.sher import diagnose_case as diagnose_case
    from sher3_gap.sher import diagnose_runs as diagnose_runs

__getattr__, __dir__ = lazy(
    __name__,
    {"errors": ("CaseError",), "evidence": ("SherEvidence",), "sher": ("Sher", "diagnose_case", "diagnose_runs")},
)
