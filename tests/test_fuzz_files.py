"""Files and requests with flipped, cut and inserted bytes: a typed error or a valid object, never anything else."""

import json
import random
from pathlib import Path

import numpy as np
import pytest
from pydantic import ValidationError
from sher3_bags import Run, RunMetadata, recover, stream, write_case, write_run
from sher3_common import Sher3Error
from sher3_description import load_robot
from sher3_effects import plants, save_effects
from sher3_faults.requests import FaultRequest, make_request, parse_request
from sher3_gap.excitation import Excitation
from sher3_gap.excitation.file import save_excitation
from sher3_machines import described
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
    return path


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


NAMES = [name for name in DOORS if not name.startswith(("table", "arm"))]


@pytest.mark.parametrize("name", NAMES)
def test_a_spoilt_file_is_refused_or_valid(name, tmp_path):
    path = write(name, tmp_path)
    raw, door, rng, refused = path.read_bytes(), DOORS[name], random.Random(name), 0
    door(path)
    for _ in range(120):
        path.write_bytes(spoil(rng, raw))
        try:
            door(path)
        except Sher3Error as error:
            refused += 1
            assert str(error)
    assert refused > 40


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
