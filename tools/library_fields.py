"""Which fields the classes have that `sher3 gap export` writes: names from a library's own wheel, as JSON.

    pip download --no-deps isaaclab==3.0.0 mjlab==1.6.0
    python tools/library_fields.py isaaclab-3.0.0-*.whl mjlab-1.6.0-*.whl > sher3_ws/src/sher3_export/test/fields.json

reads the sources in the wheels and runs nothing of them: names of fields, whether one must be given, version and
licence. The tests of `sher3_export` hold every file that it writes against this list.
"""

from __future__ import annotations

import ast
import json
import sys
from email.parser import Parser
from zipfile import ZipFile

CLASSES = {
    "isaaclab": ("isaaclab.actuators", ("IdealPDActuatorCfg", "DelayedPDActuatorCfg")),
    "mjlab": ("mjlab.actuator", ("XmlActuatorCfg", "BuiltinPositionActuatorCfg")),
}
"""Library -> module and classes of it that an export imports."""


def own_fields(node: ast.ClassDef) -> dict[str, bool]:
    """Return the fields that a class states itself, and whether each must be given."""
    fields = [x for x in node.body if isinstance(x, ast.AnnAssign) and isinstance(x.target, ast.Name)]
    return {
        x.target.id: x.value is None or (isinstance(x.value, ast.Name) and x.value.id == "MISSING")
        for x in fields
        if isinstance(x.target, ast.Name)
    }


def fields_of(name: str, classes: dict[str, ast.ClassDef]) -> dict[str, bool]:
    """Return the fields of a class and its bases; a nearer class states a field anew."""
    node, found = classes[name], {}
    for base in node.bases:
        if isinstance(base, ast.Name) and base.id in classes:
            found |= fields_of(base.id, classes)
    return found | own_fields(node)


def read(path: str) -> dict[str, object]:
    """Return version, licence, module and the fields of its classes from a wheel."""
    with ZipFile(path) as wheel:
        names = wheel.namelist()
        meta = Parser().parsestr(wheel.read(next(n for n in names if n.endswith("dist-info/METADATA"))).decode())
        module, wanted = CLASSES[meta["Name"]]
        sources = [n for n in names if n.startswith(module.replace(".", "/") + "/") and n.endswith(".py")]
        trees = [ast.parse(wheel.read(n)) for n in sources]
    classes = {x.name: x for tree in trees for x in tree.body if isinstance(x, ast.ClassDef)}
    return {
        "version": meta["Version"],
        "licence": meta["License-Expression"] or meta["License"],
        "module": module,
        "classes": {name: fields_of(name, classes) for name in wanted},
    }


if __name__ == "__main__":
    found = {str(x["module"]).split(".")[0]: x for x in map(read, sys.argv[1:])}
    print(json.dumps(found, indent=1, sort_keys=True))
