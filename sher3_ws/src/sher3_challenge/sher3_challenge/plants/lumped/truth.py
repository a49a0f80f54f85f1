"""The lumped plant as the challenge sees it."""

from __future__ import annotations

from sher3_challenge.plants import grammar
from sher3_challenge.plants.lumped.faults import drive, outside, tip
from sher3_challenge.plants.lumped.plant import LumpedPlant
from sher3_challenge.plants.plant import TruthPlant

PLANT = TruthPlant(
    name="lumped",
    summary="formulae with few elements: Maxwell slip, plays in parallel, one spring a stage; Runge-Kutta",
    library={**drive.CATALOGUE, **tip.CATALOGUE},
    outside={**outside.CATALOGUE, **grammar.CATALOGUE},
    make=LumpedPlant,
)
