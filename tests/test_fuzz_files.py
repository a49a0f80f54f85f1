"""Files and requests with flipped, cut and inserted bytes: a typed error or a valid object, never anything else."""

import json
import random
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from pydantic import ValidationError
from sher3_bags import Run, RunMetadata, recover, stream, write_case, write_run
from sher3_common import Sher3Error
from sher3_description import load_robot
from sher3_effects import plants, save_effects
from sher3_faults.requests import FaultRequest, make_request, parse_request
from sher3_gap.excitation import Excitation
from sher3_gap.excitation.file import save_excitation
from sher3_machines import described
from sher3_machines.intake.tables import read_tables
from test_file_doors import DOORS

ROBOT = load_robot()
VERDICT = {
    "schema": "sher3.verdict/2",
    "status": "no_gap",
    "where": [],
    "causes": [],
    "closure": {"stage": {"value": 0.0, "low": 0.0, "high": 0.0}, "tip": None},
    "residual": {"gap": 1e-6, "floor": 1e-6, "unit": "m"},
    "unexplained": None,
    "next_experiment": None,
    "seconds": 1.0,
    "versions": {},
}
URDF = """<robot name="a">
<link name="base"/><link name="one"><inertial><mass value="1.5"/><origin xyz="0 0 0.1" rpy="0 0 0"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.02"/></inertial></link><link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="one"/><origin xyz="0 0 0.3" rpy="0 0 0"/>
<axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="9" velocity="2"/></joint>
<joint name="j2" type="revolute"><parent link="one"/><child link="tip"/><origin xyz="0.2 0 0" rpy="0 1.5 0"/>
<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" velocity="2"/></joint></robot>
"""
PIECES = (*"{[]}:~'é\0\n", "- ", "&a ", "*a", "!!python/name:os.system", "1e999", ".nan")


def small_run() -> Run:
    stamp = 10**9 + 2_000_000 * np.arange(40)
    rows = np.random.default_rng(1).normal(size=(40, 5))
    streams = {"measured_js": stream("measured_js", stamp, position=rows)}
    return Run(streams, RunMetadata("sweep", 0, 1.0), ROBOT.to_yaml())


def write(name, folder):
    """Write a valid file for a door; return its path."""
    path = folder / name
    if name == "robot.yaml":
        path.write_text(ROBOT.to_yaml())
    elif name == "effects.yaml":
        bias = plants()["force_bias"](actuator="force_sensor", fx=0.1)
        save_effects(path, [plants()["backlash"](actuator="tilt"), bias])
    elif name == "script.yaml":
        path.write_text("schema: sher3.teleop/1\nsteps:\n  - {name: a, duration: 1.0, pedal: 0.5, command: enable}\n")
    elif name == "drives.yaml":
        path.write_text("schema: sher3.drives/1\ndrives:\n  roll: {vendor: 21320, product: 12291, serial: 4}\n")
    elif name == "machine.yaml":
        path.write_bytes(described(Path("emps")).read_bytes())
    elif name == "excitation.yaml":
        zero = np.zeros((20, 5))
        save_excitation(path, Excitation("rest", 1.0, "p", ROBOT.control_period, zero, zero, ()))
    elif name == "verdict.json":
        path.write_text(json.dumps(VERDICT))
    elif name == "case/case.yaml":
        write_case(path.parent, [small_run()], ROBOT)
    elif name == "run.mcap":
        write_run(path, small_run())
    elif name.startswith("table"):
        write_table(path)
    elif name == "arm.urdf":
        path.write_text(URDF)
    return path


def write_table(path):
    """Write ten rows of two columns in the form that the name of the file says."""
    columns = {"time": np.arange(10) * 0.01, "position": np.linspace(0.0, 1.0, 10)}
    if path.suffix == ".npz":
        np.savez_compressed(path, **columns)
    elif path.suffix == ".json":
        path.write_text(json.dumps({name: column.tolist() for name, column in columns.items()}))
    elif path.suffix == ".mat":
        scipy.io.savemat(path, columns, do_compression=True)
    else:
        rows = [",".join(columns)] + [f"{t:.3f},{x:.6f}" for t, x in zip(*columns.values(), strict=True)]
        path.write_text("\n".join(rows) + "\n")


def spoil(rng: random.Random, raw: bytes) -> bytes:
    """Return the bytes with one to three injuries."""
    data = bytearray(raw)
    for _ in range(rng.randint(1, 3)):
        at = rng.randrange(len(data) + 1)
        match rng.randrange(5):
            case 0 if at < len(data):
                data[at] = rng.randrange(256)
            case 1:
                del data[at : at + rng.randrange(1, 30)]
            case 2:
                data[at:at] = rng.choice(PIECES).encode()
            case 3:
                data[at:at] = data[rng.randrange(len(data) or 1) :][: rng.randrange(60)]
            case _:
                del data[max(1, at) :]
    return bytes(data)


SLOW_DOOR = "table.mat"
"""A door that reads in a child of its own, 0.3 s each time; it has a share of its own."""
ALL = {**DOORS, SLOW_DOOR: read_tables}
FAST, NIGHTLY, NIGHTLY_OF_SLOW = 48, 1800, 100
"""Mutations of each door: 624 in the ordinary run, 23 500 in the nightly one (`make test-slow`)."""


def mutate(name, folder, count, seed):
    """Open a door with `count` spoilt files; return how many were refused, or fail at one that was neither."""
    path = write(name, folder)
    raw, door, rng, refused = path.read_bytes(), ALL[name], random.Random(f"{name} {seed}"), 0
    door(path)
    for k in range(count):
        path.write_bytes(spoil(rng, raw))
        try:
            door(path)
        except Sher3Error as error:
            refused += 1
            assert str(error)
        except Exception as error:
            raise AssertionError(f"{name}: mutation {k} of seed {seed} gave {error!r}") from error
    return refused


@pytest.mark.parametrize("name", DOORS)
def test_a_spoilt_file_is_refused_or_valid(name, tmp_path):
    assert mutate(name, tmp_path, FAST, "fast") > 0


@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", ALL)
def test_twenty_thousand_spoilt_files_are_refused_or_valid(name, tmp_path):
    """No crash, no hang, no untyped error: twelve doors with 1800 mutations each, and one with 100."""
    assert mutate(name, tmp_path, NIGHTLY_OF_SLOW if name == SLOW_DOOR else NIGHTLY, "nightly") > 0


@pytest.mark.parametrize("share", range(0, 100, 7))
def test_a_bag_cut_anywhere_is_refused_and_recovered_or_named_empty(share, tmp_path):
    path = write("run.mcap", tmp_path)
    raw = path.read_bytes()
    path.write_bytes(raw[: len(raw) * share // 100])
    with pytest.raises(Sher3Error):
        DOORS["run.mcap"](path)
    try:
        found = recover(path)
    except Sher3Error as error:
        assert "nothing to recover" in str(error) or "not an MCAP file" in str(error)
    else:
        assert 0 < found.messages["/sher3/measured_js"] <= 40


def test_a_spoilt_fault_request_is_refused_or_valid():
    whole = make_request(component="force_sensor", fault="delayed", duration=0.5, parameters={"delay": 0.03}).to_json()
    rng, refused = random.Random(1), 0
    for _ in range(400):
        text = spoil(rng, whole.encode()).decode(errors="replace")
        try:
            assert isinstance(parse_request(text), FaultRequest)
        except Sher3Error:
            refused += 1
    assert refused > 200
    for text in ("[" * 100_000, "1" * 10_000, '{"component": ' * 5000):
        with pytest.raises(Sher3Error):
            parse_request(text)


def test_a_verdict_is_refused_by_field():
    from sher3_diagnosis.verdict import Verdict

    with pytest.raises(ValidationError, match="status"):
        Verdict.model_validate({**VERDICT, "status": "fine"})
