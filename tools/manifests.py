"""Write the dependencies of every package.xml from what the sources import, or check them with `--check`.

    python tools/manifests.py            # rewrites the <exec_depend> lines
    python tools/manifests.py --check    # prints what is missing or not imported, exits 1 if anything is

Counted are imports anywhere in a file (not those for type checks alone), modules and message types that a file names
in a string to import them later, and the middleware. Libraries have their rosdep key; keys that the public rosdep list
lacks are defined in `sher3_ws/rosdep.yaml`.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator
from pathlib import Path

SOURCES = Path(__file__).resolve().parent.parent / "sher3_ws" / "src"

KEYS = {
    "can": "python3-can",
    "canopen": "python3-canopen-pip",
    "distributed": "python3-distributed",
    "jinja2": "python3-jinja2",
    "joblib": "python3-joblib",
    "lz4": "python3-lz4",
    "matplotlib": "python3-matplotlib",
    "mcap": "python3-mcap-pip",
    "numba": "python3-numba",
    "numpy": "python3-numpy",
    "pinocchio": "pinocchio",
    "psutil": "python3-psutil",
    "pydantic": "python3-pydantic",
    "pydantic_core": "python3-pydantic",
    "rich": "python3-rich",
    "rosbags": "python3-rosbags-pip",
    "scipy": "python3-scipy",
    "typer": "python3-typer",
    "typing_extensions": "python3-typing-extensions",
    "yaml": "python3-yaml",
    "zstandard": "python3-zstandard",
}
"""The rosdep key of each library; packages of ROS and of this project are their own keys."""

OWN = re.compile(r"sher3_\w+|\w+_(msgs|srvs|interfaces)|rclpy|rmw_\w+")
MESSAGE = re.compile(r"(\w+_(?:msgs|srvs|interfaces))/(?:msg|srv)/\w+")
MODULE = re.compile(r"(sher3_\w+)(?:\.\w+)+(?::\w+)?")
MIDDLEWARE = re.compile(r"rmw_\w+_cpp")


def main() -> int:
    """Write or check all manifests; return the exit code."""
    wrong = False
    for manifest in sorted(SOURCES.glob("*/package.xml")):
        before = manifest.read_text()
        after = with_dependencies(before, dependencies(manifest.parent))
        if before == after:
            continue
        if "--check" not in sys.argv:
            manifest.write_text(after)
            continue
        wrong = True
        has, wants = set(_listed(before)), set(_listed(after))
        name = manifest.parent.name
        print(f"{name}/package.xml lacks {sorted(wants - has)}, names for nothing {sorted(has - wants)}")
    if wrong:
        print("mended by: python tools/manifests.py")
    return int(wrong)


def dependencies(package: Path) -> list[str]:
    """Return the keys of everything a package imports: this project's packages first, each group by name.

    Raises:
        KeyError: A library without a key in `KEYS`.
    """
    used = set()
    for path in sorted((package / package.name).rglob("*.py")):
        used |= set(_imports(ast.parse(path.read_text())))
    used -= {package.name, *sys.stdlib_module_names}
    keys = {name if OWN.fullmatch(name) else KEYS[name] for name in used}
    return sorted(keys, key=lambda key: (not key.startswith("sher3_"), key))


def with_dependencies(manifest: str, keys: list[str]) -> str:
    """Return a manifest with these `<exec_depend>` lines in the place of its own."""
    bare = re.sub(r" *<exec_depend>.*?</exec_depend>\n", "", manifest)
    lines = "".join(f"  <exec_depend>{key}</exec_depend>\n" for key in keys)
    return bare.replace("  <test_depend>", lines + "  <test_depend>", 1)


def _listed(manifest: str) -> list[str]:
    return re.findall(r"<exec_depend>(.*?)</exec_depend>", manifest)


def _imports(node: ast.AST) -> Iterator[str]:
    """Yield the top-level names of what a syntax tree imports."""
    if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
        return
    if isinstance(node, ast.Import):
        yield from (alias.name.split(".")[0] for alias in node.names)
    elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
        yield node.module.split(".")[0]
    elif isinstance(node, ast.Constant) and isinstance(node.value, str):
        if named := MESSAGE.fullmatch(node.value) or MODULE.fullmatch(node.value):
            yield named[1]
        elif MIDDLEWARE.fullmatch(node.value):
            yield node.value
    for child in ast.iter_child_nodes(node):
        yield from _imports(child)


if __name__ == "__main__":
    sys.exit(main())
