"""Evidence of a machine that tells its own level, kept as plain data, is judged as its verdict is."""

import numpy as np
import pytest
from sher3_challenge.calibration.held_out import judged_by
from sher3_challenge.calibration.observe import keep, observed_on, stored
from sher3_diagnosis import diagnose
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.judge.costs import Costs
from sher3_static.sensor.description import SensorDescription
from sher3_static.sensor.kind import KIND

COLUMNS = {
    "force": {"column": "f", "unit": "N"},
    "torque": {"column": "t", "unit": "N*m"},
    "applied": {
        "weight": {"column": "kg", "unit": "kg"},
        "direction": {"column": "along", "unit": "1"},
        "lever": {"column": "at", "unit": "m"},
    },
}
"""Of a force sensor under weights at known levers."""


def readings(rng):
    """Weights along each axis, of a sensor with a bias of 2 N whose z reads 5 % too much."""
    along = np.tile(np.vstack([np.eye(3), -np.eye(3)]), (20, 1))
    kg, at = rng.choice([0.0, 1.0, 2.0, 5.0], 120), rng.choice([-0.1, 0.0, 0.1], (120, 3))
    force = kg[:, None] * 9.80665 * along
    torque = np.cross(at, force) + rng.normal(0.0, 2e-3, (120, 3))
    read = force * [1.0, 1.0, 1.05] + [2.0, 0.0, 0.0] + rng.normal(0.0, 0.02, (120, 3))
    return {"f": read, "t": torque, "kg": kg, "along": along, "at": at}


@pytest.mark.parametrize("costs", [Costs(), Costs(name=1e4), Costs(abstain=1e4)])
def test_what_calibration_reads_of_a_sensor_is_judged_as_its_verdict_is(costs, tmp_path):
    described = SensorDescription.model_validate({"kind": "force_sensor", "name": "ft", **COLUMNS})
    machine, runs = KIND.machine(described), [KIND.read("run", readings(np.random.default_rng(1)), described)]
    truth = {"status": "attributed", "effects": [], "rivals": []}
    libraries = [(), ("force_scale",)]
    keep(observed_on(machine, "sensors", "1", truth, runs, libraries), tmp_path / "kept.json")
    seen = stored(tmp_path / "kept.json")
    assert all(o.own_level for o in seen)
    said = [diagnose(machine, runs, without=w, costs=costs).verdict.status for w in libraries]
    assert [j.said for j in judged_by(in_force(), seen, costs)] == said
