"""What `sher3 gap library` prints: the effects by family, or the whole page of one."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

from sher3_diagnosis.effect import INPUTS, KINDS
from sher3_effects import Page, every

from sher3_gap_cli.options import RequestError

WIDTH = 80
"""Columns of a page: what every terminal shows."""
NEEDS = {
    "lead": "its travel per motor revolution",
    "load": "an encoder behind the transmission",
    "mass": "its mass",
    "drive": "the force it is driven with",
}
"""What must be known of an axis -> plain words."""


def library_data(which: str = "") -> list[dict[str, Any]]:
    """Return effects as plain data, by family; `which` is an id or a family, all by default.

    Raises:
        RequestError: it is neither.
    """
    known = every()
    chosen = [page for page in known.values() if which in ("", page.id, page.family)]
    if not chosen:
        names = [*sorted({page.family for page in known.values()}), *known]
        if near := get_close_matches(which, names, 1):
            raise RequestError("no such effect or family", value=which, remedy=f"did you mean {near[0]}?")
        raise RequestError("no such effect or family", value=which, limit=", ".join(names))
    return [page_data(page) for page in sorted(chosen, key=lambda page: (page.family, page.id))]


def page_data(page: Page) -> dict[str, Any]:
    """Return every field of a page as plain data; units and bounds are those of a linear axis."""
    parameters: dict[str, dict[str, Any]] = {
        name: {"unit": s.unit, "low": s.low, "high": s.high, "default": s.default, "text": s.text}
        for name, s in page.specification.items()
    }
    for name, unit in page.units.items():
        low, high = page.bounds.get(name, (None, None))
        parameters.setdefault(name, {"unit": unit, "low": low, "high": high, "default": None, "text": "of the fit"})
    return {
        "effect": page.id,
        "family": page.family,
        "stage": page.stage,
        "kinds": list(page.kinds),
        "places": list(page.places),
        "sites": list(page.plant.sites) if page.plant else [],
        "explanation": page.explanation,
        "law": " ".join((type(page).__doc__ or "").split()),
        "simulated": " ".join((page.plant.__doc__ or "").split()) if page.plant else "",
        "inputs": list(page.inputs),
        "needs": list(page.needs),
        "parameters": parameters,
        "siblings": dict(page.siblings),
        "extends": list(page.extends),
        "companion": page.companion,
        "best": {"excitation": page.best.excitation, "why": page.best.why},
    }


def list_text(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return the effects as a list: id, stage, and what it is."""
    lines: list[str] = []
    family = ""
    for row in rows:
        if row["family"] != family:
            family = row["family"]
            lines += ["", family.replace("_", " ")]
        lines.append(f"  {row['effect']}  ({row['stage']})")
        lines += _wrapped(row["explanation"], "    ")
    return "\n".join([*lines[1:], "", "`sher3 gap library EFFECT` prints the page of one."])


def page_text(row: Mapping[str, Any]) -> str:
    """Return the page of an effect in plain words, at most 80 columns wide."""
    inputs = "; ".join(INPUTS[name] for name in row["inputs"]) or "nothing: a constant"
    lines = [f"{row['effect']}  ({row['family'].replace('_', ' ')}, {row['stage'].replace('_', ' ')})"]
    lines += ["", *_wrapped(row["explanation"]), ""]
    lines += _field("law", row["law"])
    lines += _field("depends on", inputs)
    lines += _field("sits on", ", ".join(row["sites"] or row["places"]))
    lines += _field("in the plant", row["simulated"])
    lines += ["", "parameters"]
    for name, p in row["parameters"].items():
        bounds = "" if p["low"] is None else f", {p['low']:g} to {p['high']:g}"
        lines += _wrapped(f"{name} [{p['unit']}{bounds}]: {p['text']}", "  ", "      ")
    lines += ["", "not to be taken for"]
    for sibling, why in row["siblings"].items():
        lines += _wrapped(f"{sibling}: {why}", "  ", "      ")
    lines.append("")
    lines += _field("contains", ", ".join(row["extends"]))
    lines += _field("shows with", row["companion"] and f"{row['companion'].replace('_', ' ')} on the same axis")
    lines += _field("best shown by", f"{row['best']['excitation']}: {row['best']['why']}")
    lines += _field("looked for on", ", ".join(KINDS.get(kind, kind) for kind in row["kinds"]))
    lines += _field("of an axis", " and ".join(NEEDS.get(need, need) for need in row["needs"]))
    return "\n".join(lines)


def _field(name: str, text: str) -> list[str]:
    return _wrapped(f"{name:<14} {text}", "", " " * 15) if text else []


def _wrapped(text: str, first: str = "", then: str | None = None) -> list[str]:
    rest = first if then is None else then
    return textwrap.wrap(text, WIDTH, initial_indent=first, subsequent_indent=rest, break_long_words=False)
