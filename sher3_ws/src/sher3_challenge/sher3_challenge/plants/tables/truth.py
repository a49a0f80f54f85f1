"""The tables plant as the challenge sees it."""

from __future__ import annotations

from sher3_challenge.plants.plant import TruthPlant
from sher3_challenge.plants.tables import faults_drive, faults_friction, faults_outside, faults_tip
from sher3_challenge.plants.tables.plant import TablesPlant

PLANT = TruthPlant(
    name="tables",
    summary="sampled laws: friction maps, gear records, two-mass stages with elastic contacts, lagging temperatures",
    library={**faults_drive.CATALOGUE, **faults_friction.CATALOGUE, **faults_tip.CATALOGUE},
    outside=dict(faults_outside.CATALOGUE),
    make=TablesPlant,
)
