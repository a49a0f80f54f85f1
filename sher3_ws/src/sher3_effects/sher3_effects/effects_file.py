"""Effects of the plant: from the causes of a verdict, and as YAML.

A file has `schema: sher3.effects/1`, `effects: [{effect, actuator, parameters: {name: value}}]`. In
it `library: [path]` names the files of discovered effects among them, from the folder of the effects file. It names no
Python: whoever loads an effects file does not mean to run it.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from sher3_common import FileError, Sher3Error, dump_yaml, parse_json, read_yaml
from sher3_description import Robot
from sher3_diagnosis.verdict import Cause
from sher3_sim.effect import PlantEffect
from sher3_sim.errors import EffectError

from sher3_effects.page import Part
from sher3_effects.registry import add_library, library, plants

SCHEMA = "sher3.effects/1"


def effect_from_dict(data: Mapping[str, Any]) -> PlantEffect:
    """Build an effect from its plain form.

    Raises:
        EffectError: unknown id, actuator or parameter, or a value out of bounds.
    """
    unknown = set(data) - {"effect", "actuator", "parameters"}
    if unknown or "effect" not in data or "actuator" not in data:
        raise EffectError(
            "an effect has the keys effect, actuator and parameters",
            value=", ".join(map(str, data)),
            remedy="give these keys and no others",
        )
    known = plants()
    if not isinstance(data["effect"], str) or data["effect"] not in known:
        raise EffectError.unknown("no such effect", data["effect"], known)
    kind, given = known[data["effect"]], data.get("parameters") or {}
    if not isinstance(given, Mapping):
        raise EffectError(f"{kind.id}: parameters are not a mapping", value=given, remedy="write them as {name: value}")
    names = kind.specification(str(data["actuator"]))
    for name in given:
        if name not in names:
            raise EffectError.unknown(f"{kind.id} has no such parameter", name, names)
    return kind(str(data["actuator"]), **given)


def effect_to_dict(effect: PlantEffect) -> dict[str, Any]:
    """Return the plain form of an effect, with all its parameters."""
    return {"effect": effect.id, "actuator": effect.actuator, "parameters": effect.parameters}


def load_effects(path: Path | str) -> list[PlantEffect]:
    """Read an effects file.

    Raises:
        FileError: it cannot be read or is not of the schema.
        EffectError: an entry is wrong.
    """
    data = read_yaml(path)
    schema = data.get("schema")
    if schema != SCHEMA:
        raise FileError("is not an effects file", path=path, value=schema, limit=SCHEMA, remedy="set schema")
    pages = data.get("library", [])
    if not isinstance(pages, list) or not all(isinstance(p, str) for p in pages):
        raise FileError("library is not a list of paths", path=path, remedy="write it as [found.yaml]")
    add_library([Path(path).parent / p for p in pages])
    entries = data.get("effects")
    if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
        raise FileError(
            "effects is not a list of mappings", path=path, remedy="write each as {effect, actuator, parameters}"
        )
    return [effect_from_dict(entry) for entry in entries]


def effects_from_text(text: str) -> list[PlantEffect]:
    """Return the effects of a JSON list of plain forms, as `mock/effects` carries them; an empty list is no effect.

    Raises:
        EffectError: it is no such list, or an entry is wrong.
    """
    try:
        entries = parse_json(text)
    except Sher3Error:
        entries = None
    if not isinstance(entries, list) or not all(isinstance(entry, Mapping) for entry in entries):
        raise EffectError(
            "effects are a JSON list of objects", value=text[:80], remedy='[{"effect": …, "actuator": …}]'
        )
    return [effect_from_dict(entry) for entry in entries]


def save_effects(path: Path | str, effects: Iterable[PlantEffect]) -> None:
    """Write an effects file that `load_effects` reads back to equal effects."""
    entries = list(effects)
    content: dict[str, Any] = {"schema": SCHEMA, "effects": [effect_to_dict(effect) for effect in entries]}
    known = library()
    sources = {str(known[e.id].source) for e in entries if e.id in known and known[e.id].source is not None}
    if sources:
        content["library"] = [os.path.relpath(source, Path(path).resolve().parent) for source in sorted(sources)]
    Path(path).write_text(dump_yaml(content), encoding="utf-8")


def to_effects(causes: Sequence[Cause], robot: Robot) -> list[PlantEffect]:
    """Return effects of the plant with the fitted parameters, clipped to what the plant allows.

    The plant takes an effect once per actuator: of parts that name the same one, the first stays. Causes without a form
    in the plant are left out.
    """
    out: dict[tuple[str, str], PlantEffect] = {}
    for cause in causes:
        values = {name: p.value for name, p in cause.parameters.items()}
        page = library().get(cause.effect)
        for part in page.to_simulator(cause.actuator, values, robot) if page and page.plant else ():
            made = _plant_effect(part)
            out.setdefault((made.id, made.actuator), made)
    return list(out.values())


def _plant_effect(part: Part) -> PlantEffect:
    """Return one effect of the plant: of the values those the plant knows; the others are explanation only."""
    kind = plants()[part.effect]
    site = part.actuator if part.actuator in kind.sites else kind.sites[0]
    given = {}
    for name, spec in kind.specification(site).items():
        if name in part.parameters:
            given[name] = min(max(part.parameters[name], spec.low), spec.high)
        elif spec.low <= 0.0 <= spec.high:
            given[name] = 0.0
    return kind(site, **given)
