"""What each target of an export can say; on a page for each, why it cannot say the rest."""

from __future__ import annotations

from itertools import groupby

from sher3_effects.page import CONSTANTS
from sher3_export.writing import TARGETS

from generators.table import table

HEAD = """# What a target can express

Constants of a joint, and the field of each target of `sher3 gap export --to` that takes it. Written from the sources;
fields are those of MuJoCo 4.0, URDF 1.0, SDF 1.9, Isaac Lab 3.0 (`isaaclab`) and 2.2 (`isaac`), mjlab 1.6 and
the schema of ros2_control in ROS 2 Jazzy. `yaml` takes all constants with their intervals. What a target has no field
for is printed by the export and stands in a comment on top of the file, with its reason.

Ripple, eccentricity, cogging per turn of a motor whose gear is not known, and friction over position are no constant of
a joint and are listed for every target. A `dcmotor` without input needs MuJoCo 4.0 and takes no control.

"""
SHOWN = [name for name in TARGETS if name != "yaml"]


def pages() -> tuple[str, dict[str, str]]:
    """Return the table of all targets, and a page for each by its file's name."""
    rows = [
        (meaning, *(_shown(TARGETS[name].fields.get(constant, "–")) for name in SHOWN))
        for constant, meaning in CONSTANTS.items()
    ]
    why = ", ".join(f"[{name}](targets/{name}.md)" for name in SHOWN)
    return HEAD + table(("constant", *SHOWN), rows) + f"\nWhy not: {why}.\n", {name: _reasons(name) for name in SHOWN}


def _shown(field: str) -> str:
    """Return a name as code, a description as it is."""
    return f"`{field}`" if field.replace("_", "").isalpha() else field


def _reasons(name: str) -> str:
    target = TARGETS[name]
    missing = [(reason, CONSTANTS[c]) for c, reason in target.refuses.items() if c not in target.fields]
    lines = [
        f"- {', '.join(meaning for _, meaning in group)}: {reason}"
        for reason, group in groupby(sorted(missing), key=lambda x: x[0])
    ]
    return "\n".join([f"# What {name} cannot express\n", *lines, ""])
