"""The tables plant as the challenge sees it."""

from __future__ import annotations

from sher3_challenge.plants import grammar
from sher3_challenge.plants.plant import TruthPlant
from sher3_challenge.plants.tables.faults import drive, friction, outside, tip
from sher3_challenge.plants.tables.plant import TablesPlant

PLANT = TruthPlant(
    name="tables",
    summary="sampled laws: friction maps, gear records, two-mass stages with elastic contacts, lagging temperatures",
    library={**drive.CATALOGUE, **friction.CATALOGUE, **tip.CATALOGUE},
    outside={**outside.CATALOGUE, **grammar.CATALOGUE},
    make=TablesPlant,
)
