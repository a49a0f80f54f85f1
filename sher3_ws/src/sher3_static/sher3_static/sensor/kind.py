"""The kind `force_sensor`: readings in known orientations in a case folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sher3_diagnosis.channel import Array
from sher3_machines.intake.kind import Kind
from sher3_machines.intake.tables import Tables

from sher3_static.sensor.description import SensorDescription
from sher3_static.sensor.machine import ForceSensor
from sher3_static.sensor.record import SensorRun, sensor_run


class SensorKind(Kind[SensorDescription, SensorRun]):
    """Force sensors; a case stores `wrench`, `turn` and `temperature`."""

    name = "force_sensor"
    description = SensorDescription

    def read(self, name: str, tables: Tables, description: SensorDescription) -> SensorRun:
        """Check a data file; raises MachineError."""
        return sensor_run(name, tables, description)

    def pack(self, run: SensorRun) -> Mapping[str, Array]:
        """Return readings, orientations and temperatures."""
        return {"wrench": run.wrench, "turn": run.turn, "temperature": run.temperature}

    def unpack(self, name: str, arrays: Tables, notes: Sequence[str]) -> SensorRun:
        """Return the record that a case stores; raises KeyError where an array is missing."""
        return SensorRun(name, arrays["wrench"], arrays["turn"], arrays["temperature"], notes)

    def machine(self, description: SensorDescription) -> ForceSensor:
        """Return the sensor."""
        return ForceSensor(description)


KIND = SensorKind()
