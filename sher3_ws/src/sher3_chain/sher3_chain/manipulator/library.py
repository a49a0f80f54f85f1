"""The effects of a joint of an arm."""

from __future__ import annotations

from sher3_diagnosis.effect import Effect
from sher3_effects import pages


def joint_pages(facts: set[str] | None = None) -> list[Effect]:
    """Return the pages for a joint of an arm: its own, and those of an axis that it does not replace."""
    own = pages("joint", facts)
    taken = {e.id for e in own}
    return [*own, *(e for e in pages("axis", facts) if e.id not in taken)]
