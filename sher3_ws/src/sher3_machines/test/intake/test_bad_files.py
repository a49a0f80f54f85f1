"""Files with flipped, cut and inserted bytes, and files that are something else: a sentence, never a traceback."""

import json
import random
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from sher3_common import Sher3Error
from sher3_machines import MachineError, import_case, kinds
from sher3_machines.drafting.draft import draft
from sher3_machines.intake.kinds import load_description
from sher3_machines.intake.tables import read_tables

TIME = np.arange(0.0, 1.0, 0.005)
AXES = """kind: axes
name: a
time: {column: t, unit: s}
axes:
  - name: a
    motion: rotary
    signals: {position: {column: q, unit: rad}, effort: {column: i, unit: N*m}}
    command_law: {kind: force}
    mass: 1.0
    encoder_resolution: 1.0e-4
"""
PIECES = (b"nan", b"1e999", b"\x00", b"[", b"{", b",", b";;", b"\xff\xfe", b'"', b"-")


def written(folder: Path, ending: str) -> Path:
    path = folder / f"a.{ending}"
    data = {"t": TIME, "q": np.sin(TIME), "i": np.cos(TIME)}
    if ending == "mat":
        scipy.io.savemat(path, data)
    elif ending == "npz":
        np.savez(path, **data)
    elif ending == "json":
        path.write_text(json.dumps({name: list(x) for name, x in data.items()}))
    else:
        np.savetxt(path, np.column_stack(list(data.values())), delimiter=",", header="t,q,i", comments="")
    return path


def spoilt(rng: random.Random, raw: bytes) -> bytes:
    data = bytearray(raw)
    for _ in range(rng.randint(1, 4)):
        at = rng.randrange(len(data) + 1)
        match rng.randrange(4):
            case 0 if at < len(data):
                data[at] = rng.randrange(256)
            case 1:
                del data[at : at + rng.randrange(1, 40)]
            case 2:
                data[at:at] = rng.choice(PIECES)
            case _:
                del data[max(1, at) :]
    return bytes(data)


def tried(path: Path, description: Path, out: Path) -> None:
    """Do with a file what the commands do; only errors of ours may come."""
    for act in (lambda: read_tables(path), lambda: draft(path), lambda: import_case([path], description, out)):
        try:
            act()
        except Sher3Error as error:
            assert error.remedy and len(str(error)) > 20, repr(error)


@pytest.mark.parametrize(("ending", "times"), [("csv", 60), ("json", 60), ("npz", 60), ("mat", 2)])
def test_a_spoilt_file_is_a_sentence(tmp_path, ending, times):
    path = written(tmp_path, ending)
    (tmp_path / "a.yaml").write_text(AXES)
    raw, rng = path.read_bytes(), random.Random(ending)
    for _ in range(times):
        path.write_bytes(spoilt(rng, raw))
        tried(path, tmp_path / "a.yaml", tmp_path / "case")


@pytest.mark.parametrize("ending", ["csv", "json", "npz", "mat", "mcap", "bag", "parquet", "xyz", "CSV"])
@pytest.mark.parametrize("content", [b"", b"\x00" * 100, b"\x89PNG\r\n\x1a\n" * 9, b"<html>", b"[]", b"t\n"], ids=repr)
def test_something_else_under_a_known_name_is_a_sentence(tmp_path, ending, content):
    path = tmp_path / f"a.{ending}"
    path.write_bytes(content)
    (tmp_path / "a.yaml").write_text(AXES)
    with pytest.raises(Sher3Error) as caught:
        import_case([path], tmp_path / "a.yaml", tmp_path / "case")
    assert caught.value.remedy and "a" in str(caught.value)


DESCRIPTIONS = {
    "axes": AXES,
    "positioning": (
        "kind: positioning\nname: a\naxes: [{name: x, target: {column: q, unit: m}, deviation: {column: i, unit: m}}]\n"
    ),
    "force_sensor": (
        "kind: force_sensor\nname: a\nforce: {column: q, unit: N}\ntorque: {column: i, unit: N*m}\n"
        "orientation: {matrix: {column: t, unit: '1'}}\n"
    ),
    "arm": (
        "kind: arm\nname: a\njoint_positions: {column: q, unit: rad}\nposes: {column: i, unit: m}\nnoise: 1.0e-4\n"
        "joints: [{name: j, a: 0.1, d: 0.0, alpha: 0.0}]\n"
    ),
}


@pytest.mark.parametrize("kind", DESCRIPTIONS)
@pytest.mark.parametrize(
    "arrays",
    [
        {"t": np.zeros(0), "q": np.zeros(0), "i": np.zeros(0)},
        {"t": np.zeros(30), "q": np.zeros(30), "i": np.zeros(30)},
        {"t": np.arange(30.0), "q": np.full(30, np.nan), "i": np.zeros(30)},
        {"t": np.arange(30.0), "q": np.zeros((30, 2, 2)), "i": np.zeros((30, 5))},
        {"t": np.arange(3.0), "q": np.zeros(30), "i": np.zeros(7)},
        {"t": np.arange(300.0), "q": np.full(300, 1e300), "i": np.full(300, -1e300)},
        {"t": np.zeros((30, 9)), "q": np.random.default_rng(1).normal(size=(30, 3)), "i": np.ones((30, 3))},
    ],
    ids=["empty", "flat", "nan", "matrices", "lengths", "huge", "no-rotation"],
)
def test_arrays_of_any_shape_are_a_sentence_for_every_kind(tmp_path, kind, arrays):
    np.savez(tmp_path / "a.npz", **arrays)
    (tmp_path / "a.yaml").write_text(DESCRIPTIONS[kind])
    with pytest.raises(Sher3Error) as caught:
        import_case([tmp_path / "a.npz"], tmp_path / "a.yaml", tmp_path / "case")
    error = caught.value
    assert error.remedy and (error.value is not None or error.limit is not None), str(error)


@pytest.mark.parametrize("kind", sorted(kinds()))
def test_a_spoilt_description_of_every_kind_is_a_sentence(tmp_path, kind):
    text = DESCRIPTIONS.get(kind, AXES.replace("kind: axes", f"kind: {kind}"))
    rng = random.Random(kind)
    for _ in range(60):
        (tmp_path / "a.yaml").write_bytes(spoilt(rng, text.encode()))
        try:
            load_description(tmp_path / "a.yaml")
        except MachineError as error:
            assert error.remedy
