"""The kind `force_sensor`: readings of six components under a load in known orientations, or under known weights."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.finding import Finding
from sher3_effects import pages
from sher3_machines.thresholds import BLOCKS

from sher3_static.kind import TableKind
from sher3_static.readings import Readings, joined, warmed
from sher3_static.reporter import Words
from sher3_static.sensor.description import SensorDescription
from sher3_static.sensor.draft import draft_sensor
from sher3_static.sensor.reading import expressed_otherwise, identify, read_sensor, scatter
from sher3_static.sensor.view import AppliedView, SensorView, TurnedView
from sher3_static.table import Table, TableEvidence

FRAMES = ("sensor", "base")
"""Frames that readings may be expressed in."""
READING = Channel("sensing", "force_sensor")
"""The one channel of a sensor."""


class SensorKind(TableKind[SensorDescription]):
    """Force sensors of six components."""

    name, description = "force_sensor", SensorDescription
    reader = staticmethod(read_sensor)
    drafter = staticmethod(draft_sensor)
    stored = ("wrench", "temperature")
    written_for = ("sensor",)
    words = Words(
        rows="{n} readings under known loads",
        whole="All readings",
        row="reading",
        parts="readings",
        end="of the reading",
        flows={"sensing": "load → reading"},
        residual={"sensing": "reading − nominal"},
    )

    def tables(self, known: SensorDescription, runs: Sequence[Readings]) -> Sequence[Table]:
        """Return all readings as one table; every eighth is held out in turn."""
        rows = joined(runs)
        view = view_of(known, rows, warmed(runs))
        floor = scatter(view, rows["run"])
        if known.noise_force is not None and known.noise_torque is not None:
            floor = np.repeat([known.noise_force, known.noise_torque], 3)
        table = Table(
            name=known.name,
            channel=READING,
            view=view,
            residual=view.reading - view.wrench(0),
            floor=floor,
            spread=view.wrench(0).std(axis=0),
            part=np.arange(view.rows) % BLOCKS,
            run=rows["run"],
            unit="N",
            pages=pages("sensor", {"orientation"} if "turn" in rows else set()),
            places={"force_sensor": (READING.actuator,)},
            zeros=np.tile(np.eye(6), (view.rows, 1, 1)),
        )
        return [table]

    def notes_on(self, finding: Finding[TableEvidence]) -> list[str]:
        """Say what is known of the load, and in which frame the readings are where this is not the stated frame."""
        view = finding.evidence.table.view
        assert isinstance(view, SensorView)
        return view.in_words()


def view_of(known: SensorDescription, rows: dict[str, Array], warmth: Array) -> SensorView:
    """Return what the effects ask of readings (g, 6) [N, N m] at a warmth (g,); an unknown load is identified first."""
    wrench, load = rows["wrench"], known.load
    if "applied" in rows:
        return AppliedView(warmth, wrench, rows["applied"])
    other = expressed_otherwise(wrench, rows["turn"], known.expressed_in) if load.mass != 0.0 else None
    found_in = "" if other is None else next(frame for frame in FRAMES if frame != known.expressed_in)
    wrench = wrench if other is None else other
    mass, moment = (
        (load.mass, load.mass * np.array(load.centre))
        if isinstance(load.mass, float)
        else identify(wrench, rows["turn"])
    )
    return TurnedView(warmth, wrench, rows["turn"], mass, moment, load.mass == "unknown", found_in)


KIND = SensorKind()
