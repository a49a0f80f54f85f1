"""The MuJoCo plant as the challenge sees it."""

from __future__ import annotations

from sher3_challenge.plants import grammar
from sher3_challenge.plants.mujoco.faults import axis, outside, tip
from sher3_challenge.plants.mujoco.plant import MujocoPlant
from sher3_challenge.plants.plant import TruthPlant

PLANT = TruthPlant(
    name="mujoco",
    summary="bodies, tendons, springs and contacts moved by MuJoCo's solver; dry friction on a creeping contact",
    library={**axis.CATALOGUE, **tip.CATALOGUE},
    outside={**outside.CATALOGUE, **grammar.CATALOGUE},
    make=MujocoPlant,
)
