"""The library of effects, a page a family, from `sher3 gap library --json`."""

from __future__ import annotations

from collections import defaultdict

from generators.command_line import run_json
from generators.table import table

INTRODUCTION = """# The library of effects

What the diagnosis knows, by family. `sher3 gap library EFFECT` prints one page of it. *Stage* is the place in the
signal chain at which the effect enters; *on* says which actuators or parts may have it.

"""


def pages() -> tuple[str, dict[str, str]]:
    """Return the index, and a page for each family by its file's name."""
    families = defaultdict(list)
    for effect in run_json("gap", "library", "--json")["effects"]:
        families[effect["family"]].append(effect)
    parts = {family.replace("_", "-"): _family(family, families[family]) for family in sorted(families)}
    rows = [
        (f"[{_title(family)}](effects/{part}.md)", ", ".join(effect["effect"] for effect in families[family]))
        for part, family in zip(parts, sorted(families), strict=True)
    ]
    return INTRODUCTION + table(("family", "effects"), rows), parts


def _title(family: str) -> str:
    return family.replace("_", " ").capitalize()


def _family(family: str, effects: list[dict]) -> str:
    return f"# {_title(family)}\n\n" + "\n".join(_effect(effect) for effect in effects)


def _effect(effect: dict) -> str:
    sites = ", ".join(f"`{site}`" for site in effect["sites"] or effect["places"])
    stage = effect["stage"].replace("_", " ")
    text = f"## {effect['effect']}\n\nStage {stage}, on {sites}. {effect['explanation']}\n\n"
    text += f"- Law: {effect['law']}\n- In the simulator: {effect['simulated']}\n"
    text += f"- Shows best in {effect['best']['excitation']}: {effect['best']['why']}\n\n" if effect["best"] else "\n"
    parameters = effect["parameters"].items()
    rows = [(f"`{name}`", p["unit"], _range(p), p["text"]) for name, p in parameters]
    text += table(("parameter", "unit", "range", "meaning"), rows) + "\n" if rows else ""
    rows = [(f"`{name}`", difference) for name, difference in effect["siblings"].items()]
    return text + (table(("not to be confused with", "which differs in this"), rows) + "\n" if rows else "")


def _range(parameter: dict) -> str:
    """Return the bounds; a parameter of the fit that the plant does not take has none."""
    low, high = parameter["low"], parameter["high"]
    return "" if low is None or high is None else f"{low:g} to {high:g}"
