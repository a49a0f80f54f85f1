"""Load cells with known errors, simulated as a test with weights: each is found with its size."""

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from sher3_static.cell.description import CellDescription
from sher3_static.cell.kind import KIND
from sher3_static.cell.reading import read_cell, unloading

NOISE = 0.05


def weighed(cycles=3, zero=0.0, gain=1.0, bow=0.0, loop=0.0, creep=0.0, seed=1):
    """Readings of a cell of 500 N, N: loaded and unloaded in steps of 50 N."""
    up = np.arange(0.0, 501.0, 50.0)
    force = np.concatenate([np.tile(np.concatenate([up, up[-2:0:-1]]), cycles), [0.0]])
    u, falling = force / 500.0, np.concatenate([[False], np.diff(force) < 0.0])
    noise = np.random.default_rng(seed).normal(0.0, NOISE, len(force))
    reading = zero + gain * force + bow * np.sin(np.pi * u) + loop * np.sin(np.pi * u) * falling
    return {"force": force, "mv": (reading + creep * np.linspace(0, 1, len(force)) + noise) / 50.0}


def description(factor=50.0, **more):
    columns = {"applied": {"column": "force", "unit": "N"}, "reading": {"column": "mv", "unit": "1", "factor": factor}}
    return CellDescription.model_validate({"kind": "load_cell", "name": "cell", **columns, **more})


def found(*data, **more):
    described = description(**more)
    runs = [read_cell(f"run {i}", x, described) for i, x in enumerate(data)]
    verdict = diagnose(KIND.machine(described), runs).verdict
    return verdict, {c.effect: {name: p.value for name, p in c.parameters.items()} for c in verdict.causes}


def test_a_healthy_cell_has_no_gap():
    assert sum(found(weighed(seed=seed))[0].status != "no_gap" for seed in range(10)) <= 1


@pytest.mark.parametrize(
    ("errors", "effect", "parameter", "value"),
    [
        ({"zero": 1.0}, "force_bias", "force", 1.0),
        ({"gain": 0.988}, "force_scale", "relative", -0.012),
        ({"bow": 1.5}, "force_nonlinearity", "largest", 1.5),
        ({"loop": 1.0}, "force_hysteresis", "loop", 1.0),
        ({"creep": 1.0}, "force_drift", "over_test", 1.0),
    ],
)
def test_each_error_is_found_with_its_size(errors, effect, parameter, value):
    verdict, causes = found(weighed(**errors))
    assert verdict.status == "attributed" and list(causes) == [effect]
    assert causes[effect][parameter] == pytest.approx(value, rel=0.15)


def test_torque_has_its_unit():
    verdict, _ = found(weighed(zero=1.0), measures="torque")
    assert verdict.causes[0].parameters["force"].unit == "N*m"


def test_one_pass_without_repeats_is_judged():
    data = {name: x[:21] for name, x in weighed(loop=1.0).items()}
    assert list(found(data)[1]) == ["force_hysteresis"]


def test_a_force_that_stays_keeps_its_side():
    assert unloading(np.array([0.0, 1.0, 1.0, 2.0, 1.0, 1.0, 0.0, 1.0])).tolist() == [0, 0, 0, 0, 1, 1, 1, 0]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"mv": np.zeros(61)}, r"mv never changes: a dead channel; value 0; connect it"),
        ({"mv": -weighed()["mv"]}, r"falls as the force grows.*other sign"),
        ({"mv": 1e3 * weighed()["mv"]}, r"another size than the force; value 1000 times; limit .*; .*0.05 would make"),
        ({"force": np.repeat([0.0, 500.0], [30, 31])}, r"too few different forces; value 2; limit 3; apply"),
        ({"mv": np.zeros(4)}, r"mv has other rows; value \(4,\)"),
    ],
)
def test_bad_records_are_refused_with_a_remedy(change, said):
    with pytest.raises(MachineError, match=said):
        read_cell("a", {**weighed(), **change}, description())


def test_few_readings_are_refused_and_two_records_count_together():
    up, down = ({name: x[part] for name, x in weighed(zero=2.0).items()} for part in (slice(0, 11), slice(10, 21)))
    with pytest.raises(MachineError, match="too few readings; value 11; limit 12; record more"):
        found(up)
    assert found(up, down)[1] == {"force_bias": {"force": pytest.approx(2.0, abs=0.1)}}


@pytest.mark.parametrize("seed", range(4))
def test_the_zero_of_a_cell_is_what_it_reads_at_no_load(seed):
    """A cell that is pulled and pushed, whose gain differs between the two, reads nothing where nothing hangs."""
    draw = np.random.default_rng(seed)
    ends = draw.uniform(300.0, 500.0), -draw.uniform(200.0, 400.0)
    steps = [np.linspace(a, b, 12)[:-1] for a, b in ((0.0, ends[0]), (ends[0], ends[1]), (ends[1], 0.0))]
    force = np.concatenate([*steps * 2, [0.0]])
    reading = 0.97 * force + 6.0 * (force / 400.0) ** 2 + draw.normal(0.0, NOISE, len(force))
    _, causes = found({"force": force, "mv": reading / 50.0})
    assert set(causes) == {"force_scale", "force_nonlinearity"}
