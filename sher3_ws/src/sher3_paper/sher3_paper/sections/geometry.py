"""Radii of the chosen and the previous design."""

from __future__ import annotations

import numpy as np

from sher3_paper.comparison import Comparison, Section, compare, computed
from sher3_paper.search.design import BEFORE, CHOSEN, base_radius, platform_radius
from sher3_paper.tables import printed

COMMAND = "sher3 paper --only geometry"


def geometry() -> Section:
    """Return the part on radii and leg offsets."""
    values = printed()["optimisation"]
    chosen, before = values["chosen"], values["before"]
    r_b = float(base_radius(CHOSEN.link_length, CHOSEN.leg_width, CHOSEN.inclination)) * 1e3
    r_b_before = before["r_p"] + BEFORE.link_length * np.sin(BEFORE.inclination) * 1e3
    r_p, r_p_before = (float(platform_radius(d.leg_width)) * 1e3 for d in (CHOSEN, BEFORE))
    lean = float(np.degrees(np.arcsin(CHOSEN.leg_offset() / CHOSEN.link_length)))
    lines = [
        compare("r_p, chosen", "mm", chosen["r_p"], r_p, 0.05, COMMAND, "eq. (14) with r_SR = 12.5 mm"),
        compare("r_b, chosen", "mm", chosen["r_b"], r_b, 0.1, COMMAND, "r_p + L sin(psi); printed truncated"),
        _against("r_p, before", before["r_p"], r_p_before, "joint radius"),
        _against("r_b, before", before["r_b"], r_b_before, "r_b before"),
        computed("R, chosen, circumradius", "mm", CHOSEN.leg_offset() * 1e3, COMMAND, "the reading taken"),
        computed("R, chosen, mid-plane", "mm", CHOSEN.leg_offset("midplane") * 1e3, COMMAND, "the other reading"),
        computed("inclination of the legs, chosen", "deg", lean, COMMAND, "inconsistency 'inclination'"),
    ]
    text = (
        "Radii are circumradii, from the axis to a ball centre; the leg offset R follows from them and the leg width."
    )
    return Section("geometry", "Geometry of the delta stage", text, lines)


def _against(quantity: str, printed_value: float, value: float, inconsistency: str) -> Comparison:
    note = f"inconsistency '{inconsistency}'"
    return Comparison(quantity, "mm", printed_value, float(value), "inconsistent", COMMAND, note)
