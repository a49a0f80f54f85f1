"""Sim-to-real gap diagnosis: where, which effect, how far it shrinks."""

from sher3_gap.diagnose import Diagnosis as Diagnosis
from sher3_gap.diagnose import diagnose as diagnose
from sher3_gap.diagnose import diagnose_case as diagnose_case
from sher3_gap.diagnose import diagnose_runs as diagnose_runs
from sher3_gap.errors import CaseError as CaseError
from sher3_gap.verdict import Verdict as Verdict
