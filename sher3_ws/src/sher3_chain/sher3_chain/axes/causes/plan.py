"""How the causes of one axis are looked for."""

from __future__ import annotations

from sher3_diagnosis.attribute.plan import Opening, SearchPlan
from sher3_diagnosis.thresholds import WORTH

from sher3_chain.axes.causes.balance_at_rest import rest_loss, rivals_at_rest
from sher3_chain.axes.causes.behind_encoder import friction_then_hidden, something_hides
from sher3_chain.axes.causes.confounded_laws import parted_by_travel
from sher3_chain.axes.causes.parted_by_release import parted_by_release
from sher3_chain.search.away_from_reversals import without_reversal_only
from sher3_chain.search.one_joint import possible_at_one_joint

AXIS = SearchPlan(
    down_to_floor=True,
    possible=possible_at_one_joint,
    together=True,
    beyond=rest_loss,
    openings=(Opening(friction_then_hidden, something_hides, worth=WORTH, unseen=True),),
    reviews=(rivals_at_rest, parted_by_travel, without_reversal_only, parted_by_release),
)
"""Plain laws at once, then richer ones; where an axis has one encoder, a second search starts with what may hide behind
it. In the end the forces at rest and the travel tell rivals apart, causes that only reversals show are left out, and
the motion of an axis that is let go tells which of the rivals foretells it."""
