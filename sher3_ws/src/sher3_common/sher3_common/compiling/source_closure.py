"""Digest of all sources of this project that a source file imports, directly or through others.

Found by reading the files, not by asking what is loaded: the answer then depends neither on the order of imports nor on
who asks. Imports inside functions count too. Imports for type checks alone do not, except in a package's face: there
they name what the face hands on.
"""

from __future__ import annotations

import functools
import hashlib
import re
from collections.abc import Iterator
from importlib.util import find_spec, resolve_name
from pathlib import Path

PROJECT = "sher3_"
"""The packages of this project begin with this; what others hold changes only with their version."""

DIGEST_LETTERS = 16
"""Hexadecimal letters of a digest: 64 bits tell the few thousand states of a working copy apart."""

_IMPORT = re.compile(
    r"^[ \t]*(?:from[ \t]+([\w.]+)[ \t]+import[ \t]+(\([^)]*\)|[^\n#;]*)|import[ \t]+([^\n#;]*))", re.MULTILINE
)

_FOR_TYPES = re.compile(r"^if TYPE_CHECKING:\n(?:[ \t]+[^\n]*\n|\n)+", re.MULTILINE)


def closure_digest(path: Path, module: str = "") -> str:
    """Return a short digest of a source file and of all project files it depends on.

    Args:
        path: The file.
        module: Its dotted name, which relative imports in it need.

    Raises:
        OSError: One of the files cannot be read.
    """
    digest = hashlib.sha256()
    for name, source in sorted(_closure(path, module).items()):
        digest.update(name.encode() + b"\0" + _read(source, name)[0])
    return digest.hexdigest()[:DIGEST_LETTERS]


def _closure(path: Path, module: str) -> dict[str, Path]:
    """Return the files by module name, the first one included."""
    found = {module: path}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        for wanted in _read(found[name], name)[1]:
            source = _file(wanted)
            if source is not None and wanted not in found:
                found[wanted] = source
                waiting.append(wanted)
    return found


@functools.cache
def _read(path: Path, module: str) -> tuple[bytes, tuple[str, ...]]:
    """Return the digest of a file and the project's modules it imports; it is read once in a process."""
    content = path.read_bytes()
    face = path.name == "__init__.py"
    text = content.decode() if face else _FOR_TYPES.sub("", content.decode())
    package = module if face else module.rpartition(".")[0]
    wanted = {name for name in _imported(text, package) if name.startswith(PROJECT)}
    return hashlib.sha256(content).digest(), tuple(sorted(wanted))


def _imported(text: str, package: str) -> Iterator[str]:
    """Yield the modules that a source imports; a name from a package is a module of it or comes from its face."""
    for origin, names, modules in _IMPORT.findall(text):
        if modules:
            yield from (part.split()[0] for part in modules.split(",") if part.strip())
            continue
        if origin.startswith("."):
            origin = resolve_name(origin, package) if package else ""
        listed = (line.partition("#")[0] for line in names.strip("()").splitlines())
        for part in ",".join(listed).split(","):
            name = f"{origin}.{part.split()[0]}" if part.strip() else origin
            yield name if _file(name) else origin


@functools.cache
def _file(module: str) -> Path | None:
    """Return the source of a module of this project; None if the name is no module or of another project."""
    if not module.startswith(PROJECT):
        return None
    top, _, rest = module.partition(".")
    spec = find_spec(top)
    for folder in (spec.submodule_search_locations or ()) if spec else ():
        base = Path(folder, *rest.split(".")) if rest else Path(folder)
        for path in (base.with_suffix(".py"), base / "__init__.py"):
            if path.is_file():
                return path
    return None
