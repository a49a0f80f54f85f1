"""Every file the robot reads, at every door: bounded in size and kind, plain data only, and a typed error otherwise."""

import contextlib
import os
import socket
import struct
import zipfile
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from hypothesis import given, settings
from hypothesis import strategies as st
from sher3_bags import read_case, read_run
from sher3_bringup.surgeon.script import load_script
from sher3_common import FileError, Sher3Error, parse_json, parse_yaml, read_bytes, read_json, read_text, read_yaml
from sher3_common.files.arrays import read_arrays
from sher3_common.files.text import MAX_CONFIGURATION_BYTES, MAX_DEPTH
from sher3_description import load_robot
from sher3_drivers.name_plates import load_name_plates
from sher3_effects import load_effects
from sher3_gap.excitation.file import load_excitation
from sher3_gap.simulate.apply import read_verdict
from sher3_machines import load_description
from sher3_machines.intake.tables import read_tables
from sher3_static.arm.urdf import arm_from_urdf

ROBOT = load_robot()
HEADER = "schema: sher3.excitation/1\nname: a\namplitude: 1.0\nperiod: 0.002\ndata: "

DOORS = {
    "robot.yaml": load_robot,
    "effects.yaml": load_effects,
    "script.yaml": load_script,
    "drives.yaml": load_name_plates,
    "machine.yaml": load_description,
    "excitation.yaml": lambda path: load_excitation(path, ROBOT),
    "verdict.json": read_verdict,
    "case/case.yaml": lambda path: read_case(path.parent),
    "run.mcap": read_run,
    "table.npz": read_tables,
    "table.csv": read_tables,
    "table.json": read_tables,
    "arm.urdf": lambda path: arm_from_urdf(path, "base", "tip"),
}
YAML_DOORS = [name for name in DOORS if name.endswith(".yaml")]


def door_and_path(name: str, folder: Path):
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    return DOORS[name], path


def refusal(door, path) -> str:
    with pytest.raises(Sher3Error) as caught:
        door(path)
    assert path.name in str(caught.value) or path.parent.name in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("name", DOORS)
def test_what_is_no_regular_file_is_refused_and_never_waited_for(name, tmp_path):
    """A pipe without a writer and a terminal would hold a reader for ever."""
    door, path = door_and_path(name, tmp_path)
    refusal(door, path)
    path.symlink_to(path)
    refusal(door, path)
    path.unlink()
    os.mkfifo(path)
    refusal(door, path)
    path.unlink()
    path.symlink_to("/dev/zero")
    refusal(door, path)
    path.unlink()
    path.mkdir()
    refusal(door, path)


@pytest.mark.parametrize("name", DOORS)
def test_a_huge_file_is_refused_by_its_size_before_it_is_read(name, tmp_path):
    """The file is a hole of a tebibyte: reading it would not fit the memory."""
    door, path = door_and_path(name, tmp_path)
    with path.open("wb") as file:
        file.truncate(1 << 40)
    text = refusal(door, path)
    assert "too large" in text and str(1 << 40) in text and "limit" in text


@pytest.mark.parametrize("name", [name for name in DOORS if name != "table.csv"])  # any text is a table
@pytest.mark.parametrize(
    "content", [b"", b"\0" * 100, b"\xff\xfe\xfd", b"[", b"{", b"PK\x03\x04" + bytes(50), b"- a\n"]
)
def test_garbage_is_refused(name, content, tmp_path):
    door, path = door_and_path(name, tmp_path)
    path.write_bytes(content)
    refusal(door, path)


@pytest.mark.parametrize("name", YAML_DOORS)
@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a: &a [x, x]\nb: &b [*a, *a]\nc: [*b, *b]\n", "alias"),
        ("a: !!python/object/apply:os.system ['false']\n", "YAML tag"),
        ("a: !!python/name:os.system\n", "YAML tag"),
        ("a: !!float 1\n", "YAML tag"),
        ("a: !x {b: 1}\n", "YAML tag"),
        ("a: 1:30\n", "YAML 1.1"),
        ("a: -190:20:30.15\n", "YAML 1.1"),
        ("a: 010\n", "YAML 1.1"),
        ("a: 0x1F\n", "YAML 1.1"),
        ("a: " + "[" * 200 + "]" * 200, "nested too deeply"),
        ("{a: " * 200 + "1" + "}" * 200, "nested too deeply"),
        ("schema: x\nschema: y\n", "given twice"),
        ("a: 1" + "0" * 5000 + "\n", "not valid YAML"),
        ("a: 1\n---\nb: 2\n", "not valid YAML"),
    ],
)
def test_yaml_that_is_not_plain_data_is_refused(name, text, says, tmp_path):
    door, path = door_and_path(name, tmp_path)
    path.write_text(text)
    assert says in refusal(door, path)


def test_plain_data_is_read_as_people_read_it():
    text = "a: 10\nb: '1:30'\nc: 1e-3\nd: 0\ne: 0.5\nf: -3\ng: '010'\nh: a:b\ni: 00:1a\n"
    found = parse_yaml(text)
    assert (found["a"], found["b"], found["d"], found["e"], found["f"], found["g"]) == (10, "1:30", 0, 0.5, -3, "010")
    assert (found["h"], found["i"]) == ("a:b", "00:1a")


def test_an_alias_bomb_costs_nothing(tmp_path):
    """Nine levels of nine aliases would be 9^9 entries."""
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, 9)]
    path = tmp_path / "bomb.yaml"
    path.write_text("\n".join(lines))
    with pytest.raises(FileError, match="YAML alias; value line 2"):
        read_yaml(path)


def test_limits_name_size_and_limit(tmp_path):
    path = tmp_path / "big.yaml"
    path.write_bytes(b"#" * (MAX_CONFIGURATION_BYTES + 1))
    for read in (read_text, read_yaml, read_json, read_bytes):
        with pytest.raises(FileError, match="too large") as caught:
            read(path)
        assert (caught.value.value, caught.value.limit) == (MAX_CONFIGURATION_BYTES + 1, MAX_CONFIGURATION_BYTES)
    path.write_bytes(b"#" * MAX_CONFIGURATION_BYTES)
    assert len(read_bytes(path)) == MAX_CONFIGURATION_BYTES
    assert parse_yaml("a: " + "[" * (MAX_DEPTH - 1) + "]" * (MAX_DEPTH - 1))
    with pytest.raises(FileError, match="deeply"):
        parse_yaml("a: " + "[" * MAX_DEPTH + "]" * MAX_DEPTH)


def test_pipes_devices_and_folders_are_told_by_their_kind(tmp_path):
    """By their kind, not by being empty: a device is never opened, since opening one can do something."""
    os.mkfifo(tmp_path / "pipe")
    for path, kind in ((tmp_path / "pipe", "pipe"), (Path("/dev/zero"), "device"), (tmp_path, "folder")):
        with pytest.raises(FileError, match=f"is not a regular file; value {kind}"):
            read_bytes(path)


def test_a_socket_is_refused(tmp_path):
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(str(tmp_path / "s"))
        with pytest.raises(FileError, match="socket"):
            read_bytes(tmp_path / "s")


def test_json_is_bounded_in_depth_and_digits(tmp_path):
    path = tmp_path / "verdict.json"
    path.write_text("[" * 100_000)
    refusal(DOORS["verdict.json"], path)
    with pytest.raises(FileError, match="deeply"):
        parse_json("[" * 100_000 + "]" * 100_000)
    with pytest.raises(FileError, match="not valid JSON"):
        parse_json("1" * 10_000)


def test_urdf_entities_are_refused(tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(
        '<?xml version="1.0"?>\n<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/hostname">]>\n<robot>&a;</robot>'
    )
    assert "document type" in refusal(DOORS["arm.urdf"], path)


def npz(**arrays) -> bytes:
    out = BytesIO()
    np.savez_compressed(out, **arrays)
    return out.getvalue()


def test_arrays_come_back_equal_and_whole(tmp_path):
    given_arrays = {
        "a": np.arange(6.0).reshape(2, 3),
        "b": np.asfortranarray(np.arange(6).reshape(2, 3)),
        "c": np.empty(0),
    }
    path = tmp_path / "a.npz"
    path.write_bytes(npz(**given_arrays))
    back = read_arrays(path)
    assert list(back) == ["a", "b", "c"] and all(np.array_equal(back[k], x) for k, x in given_arrays.items())
    assert list(read_arrays(path, ["b"])) == ["b"]
    with pytest.raises(FileError, match="lacks an array; value d; limit a, b, c"):
        read_arrays(path, ["d"])


def test_arrays_that_unpack_to_too_much_are_refused_before_they_do(tmp_path):
    path = tmp_path / "bomb.npz"
    path.write_bytes(npz(a=np.zeros(1_000_000)))  # 8 MB in 8 kB
    assert path.stat().st_size < 20_000
    with pytest.raises(FileError, match="unpacks to too much") as caught:
        read_arrays(path, max_bytes=1_000_000)
    assert caught.value.value > 8_000_000 and caught.value.limit == 1_000_000


def test_an_array_that_declares_more_than_it_holds_is_refused(tmp_path):
    out = BytesIO()
    np.lib.format.write_array_header_1_0(out, {"descr": "<f8", "fortran_order": False, "shape": (10**15,)})
    path = tmp_path / "lie.npz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.npy", out.getvalue() + bytes(80))
    with pytest.raises(FileError, match="declares what it does not hold"):
        read_arrays(path)


def member(header: str) -> bytes:
    """A member of an npz file with a header of any text, as NumPy's version 1.0 frames it."""
    text = header.encode("latin1")
    text += b" " * (-(11 + len(text)) % 64) + b"\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + bytes(64)


HEADERS = [
    "{'descr': '(",
    "{'descr': " + "(" * 3000 + ")" * 3000 + "}",
    "{'descr': " + "-" * 9000 + "1}",
    "\0",
    "f\n g",
]


@pytest.mark.parametrize("header", HEADERS)
def test_an_npz_header_that_is_no_header_is_refused(header, tmp_path):
    """NumPy reads it as Python, whose parser has errors of its own: of tokens, of syntax, of its stack."""
    path = tmp_path / "header.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.npy", member(header))
    with pytest.raises(FileError, match="no whole npz file"):
        read_arrays(path)


@pytest.mark.parametrize("method", [zipfile.ZIP_LZMA, zipfile.ZIP_BZIP2])
def test_an_npz_that_numpy_would_not_pack_so_is_refused(method, tmp_path):
    path = tmp_path / "packed.npz"
    with zipfile.ZipFile(path, "w", method) as archive:
        archive.writestr("a.npy", member("{'descr': '<f8', 'fortran_order': False, 'shape': (8,), }"))
    with pytest.raises(FileError, match="packed by method"):
        read_arrays(path)


@pytest.mark.parametrize("effect", ["[]", "{a: 1}", "3", "null"])
def test_an_effect_without_a_name_is_a_typed_error(effect, tmp_path):
    path = tmp_path / "effects.yaml"
    path.write_text(f"schema: sher3.effects/1\neffects:\n- {{effect: {effect}, actuator: tilt}}\n")
    with pytest.raises(Sher3Error, match="no such effect"):
        load_effects(path)


def test_a_mat_file_that_unpacks_to_too_much_is_refused(tmp_path, monkeypatch):
    path = tmp_path / "bomb.mat"
    scipy.io.savemat(path, {"a": np.zeros(1_000_000)}, do_compression=True)
    assert path.stat().st_size < 20_000 and len(read_tables(path)["a"]) == 1_000_000
    monkeypatch.setattr("sher3_machines.intake.readers.native.MAX_BYTES", 1_000_000)
    with pytest.raises(Sher3Error, match="unpacks to too much"):
        read_tables(path)


def test_objects_are_never_unpickled(tmp_path):
    class Trap:
        def __reduce__(self):
            return os.mkdir, (str(tmp_path / "sprung"),)

    path = tmp_path / "trap.npz"
    path.write_bytes(npz(position=np.array([Trap()], dtype=object)))
    with pytest.raises(FileError):
        read_arrays(path)
    with pytest.raises(Sher3Error):
        read_tables(path)
    assert not (tmp_path / "sprung").exists()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("spoilt")


@settings(max_examples=150, deadline=None, derandomize=True)
@given(st.data())
def test_a_spoilt_npz_is_an_error_or_arrays(folder, data):
    raw = bytearray(npz(a=np.arange(20.0)))
    for _ in range(data.draw(st.integers(1, 4))):
        raw[data.draw(st.integers(0, len(raw) - 1))] = data.draw(st.integers(0, 255))
    del raw[data.draw(st.integers(1, len(raw))) :]
    path = folder / "spoilt.npz"
    path.write_bytes(raw)
    with contextlib.suppress(FileError):
        assert all(isinstance(x, np.ndarray) for x in read_arrays(path).values())


@pytest.mark.parametrize("name", ["../other.npz", "/etc/hostname", "a/b.npz", "..", ".", "''", '"a\\0b.npz"'])
def test_the_samples_of_an_excitation_lie_beside_its_header(name, tmp_path):
    folder = tmp_path / "inner"
    folder.mkdir()
    (tmp_path / "other.npz").write_bytes(npz(position=np.zeros((9, 5)), velocity=np.zeros((9, 5))))
    (folder / "e.yaml").write_text(HEADER + name + "\n")
    with pytest.raises(FileError, match="plain name"):
        load_excitation(folder / "e.yaml", ROBOT)


def test_the_samples_of_an_excitation_are_bounded(tmp_path):
    (tmp_path / "e.yaml").write_text(HEADER + "e.npz\n")
    (tmp_path / "e.npz").write_bytes(npz(position=np.zeros((700_000, 5)), velocity=np.zeros((700_000, 5))))
    with pytest.raises(FileError, match="unpacks to too much"):
        load_excitation(tmp_path / "e.yaml", ROBOT)
