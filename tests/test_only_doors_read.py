"""The rule, over the sources: nothing but the doors opens a file for reading, and no text becomes an object."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

from sources import FILES, ROOT

READERS = {
    "read_text",
    "read_bytes",
    "open",
    "fromfile",
    "genfromtxt",
    "loadtxt",
    "load",
    "safe_load",
    "full_load",
    "parse",
}
MAKES = {"eval", "exec", "unsafe_load", "full_load", "load_all", "Loader", "load"}
"""Last names of calls that may make an object of a text."""
WATCHED = (ast.Import, ast.ImportFrom, ast.Call)
OWN_FILES = {
    "sher3_common/files/text.py": "the door itself",
    "sher3_common/compiling/source_closure.py": "digest of our own sources",
    "sher3_bags/writing.py": "writes",
    "sher3_bags/recording/recorder.py": "writes",
    "sher3_bags/recovery.py": "writes",
    "sher3_bags/messages.py": "message definitions of the installation",
    "sher3_cli/root.py": "the null device",
    "sher3_bringup/cli.py": "prints the demo script of the package",
    "sher3_bringup/processes/only_robot.py": "a lock, which has no content",
    "sher3_common/compiling/turn.py": "a lock, which has no content",
    "sher3_view/page.py": "the page's own parts, which come with the package",
    "sher3_challenge/cases/seal.py": "digest of the folder it has just written",
    "sher3_drivers/pedal/hid.py": "the pedal, a device",
    "sher3_runtime/publishers.py": "processes, as the kernel lists them",
    "sher3_safety/kept.py": "appends",
    "sher3_bringup/surgeon/device.py": "a joystick, a device",
}


@cache
def nodes(path: Path) -> list[ast.AST]:
    """The imports and calls of a file."""
    return [node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, WATCHED)]


def calls(path: Path):
    """The calls of a file as (name of the object or '', name, line)."""
    for node in nodes(path):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute | ast.Name):
            plain = isinstance(node.func, ast.Name)
            name = node.func.id if plain else node.func.attr
            if name in READERS:
                yield "" if plain else ast.unparse(node.func.value), name, node.lineno


def short(path: Path) -> str:
    return "/".join(path.relative_to(ROOT / "sher3_ws" / "src").parts[1:])


def test_files_are_read_through_the_door_alone():
    ours = {"read_text", "read_bytes", "read_json", "read_yaml", "parse_yaml"}  # as plain functions of sher3_common
    found = {}
    for path in FILES:
        for owner, name, line in calls(path):
            through_the_door = (owner == "" and name in ours) or owner in ("text", "cls", "self")
            if not through_the_door and _reads(owner, name):
                found.setdefault(short(path), []).append(f"{line}: {owner}.{name}")
    strangers = {path: lines for path, lines in found.items() if path not in OWN_FILES}
    assert not strangers, "read through sher3_common (read_text, read_yaml, read_json, read_arrays)"
    assert set(OWN_FILES) <= set(found) | {"sher3_common/files/text.py"}, "an exception that is no longer needed"


def _reads(owner: str, name: str) -> bool:
    """Whether a call of such a name opens a file: `zipfile.open` of a member and our own `load`s do not."""
    if name in ("load", "parse"):
        return owner in ("np", "numpy", "yaml", "json", "ElementTree", "joblib", "pickle", "tomllib", "marshal")
    if name == "open":
        return owner in ("", "os", "io", "gzip", "codecs") or not owner.startswith(("archive", "webbrowser"))
    return True


def test_nothing_is_unpickled_and_no_yaml_or_text_becomes_an_object():
    """`Sher3Error` defines how it crosses between our own processes; joblib's workers are our own forks."""
    forbidden = {"pickle", "cPickle", "_pickle", "dill", "cloudpickle", "shelve", "marshal", "jsonpickle"}
    for path in FILES:
        for node in nodes(path):
            if isinstance(node, ast.Import | ast.ImportFrom):
                names = [alias.name for alias in node.names] + [getattr(node, "module", None) or ""]
                assert not forbidden & {name.split(".")[0] for name in names}, path
            if isinstance(node, ast.Call):
                name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                called = ast.unparse(node.func) if name in MAKES else ""
                assert called not in ("eval", "exec", "builtins.eval", "builtins.exec"), f"{path}:{node.lineno}"
                assert not any(k.arg == "allow_pickle" and ast.unparse(k.value) != "False" for k in node.keywords), path
                assert called not in ("yaml.unsafe_load", "yaml.full_load", "yaml.load_all", "yaml.Loader"), path
                if called == "yaml.load":
                    loaders = [ast.unparse(k.value) for k in node.keywords if k.arg == "Loader"]
                    assert loaders == ["_StrictLoader"], f"{path}:{node.lineno}"
