"""The standard excitation set: set-points that make the effects of the library show and tell them apart."""

from sher3_gap.excitation.catalogue import POSTURES, Entry, catalogue, excite
from sher3_gap.excitation.excitation import Excitation, ExcitationError, check_limits

__all__ = ["POSTURES", "Entry", "Excitation", "ExcitationError", "catalogue", "check_limits", "excite"]
