"""README and pages state the budgets that settings and matrix are held against, and no others."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from sher3_control.motion.speed_cap import Regime
from sher3_control.settings import ControlSettings
from sher3_description import load_robot
from sher3_faults.budget import CUT_OFF, RUNAWAY

ROOT = Path(__file__).parents[2]
MOTION = ControlSettings.from_robot(load_robot()).motion
NEAR, FREE = (f"{travel * 1e6:g}" for travel in (MOTION.near_travel, MOTION.free_travel))
NEAR_AXIS, FREE_AXIS = (f"{RUNAWAY[regime] * 1e6:g}" for regime in (Regime.NEAR_TISSUE, Regime.FREE))
NEAR_CUT, FREE_CUT = (f"{CUT_OFF[regime] * 1e6:g}" for regime in (Regime.NEAR_TISSUE, Regime.FREE))
STATED = {
    "README.md": (
        f"more than {NEAR} µm near tissue or {FREE} µm elsewhere are refused",
        f"are held to {NEAR_AXIS} and {FREE_AXIS} µm",
        f"near_tissue: tip speed {MOTION.near_speed * 1e3:g} mm/s, budget {NEAR} um",
        f"free: tip speed {MOTION.free_speed * 1e3:g} mm/s, budget {FREE} um",
    ),
    "docs/explanation/safety.md": (
        f"Near tissue it may be {NEAR} µm, elsewhere {FREE} µm",
        f"it is {NEAR_AXIS} and {FREE_AXIS} µm",
    ),
    "docs/reference/safety.md": (
        f"| `near_tissue` | {MOTION.near_speed * 1e3:g} mm/s, {MOTION.near_turning:g} rad/s | {NEAR} um |",
        f"| `free` | {MOTION.free_speed * 1e3:g} mm/s, {MOTION.free_turning:g} rad/s | {FREE} um |",
        f"| {NEAR} um | near tissue | one fault",
        f"| {NEAR_AXIS} um | near tissue | one axis that goes by itself",
        f"| {NEAR_AXIS} um | near tissue | one to five such axes",
        f"| {FREE} um | free | all of these",
        f"| {NEAR_CUT} um, {FREE_CUT} um | near tissue, free | stated",
    ),
    "docs/reference/safety-search.md": (f"held against {NEAR_AXIS} um near tissue and {FREE_AXIS} um free",),
}


@pytest.mark.parametrize("page", STATED)
def test_a_page_states_the_budgets_of_the_settings(page):
    text = re.sub(r"\s+", " ", (ROOT / page).read_text(encoding="utf-8"))
    assert not [words for words in STATED[page] if words not in text]


def test_the_budget_of_axes_in_the_free_regime_is_that_of_all_faults():
    assert FREE_AXIS == FREE
