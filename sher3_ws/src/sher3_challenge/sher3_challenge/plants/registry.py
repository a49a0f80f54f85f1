"""The truth plants there are: the folders beside this file. A plant is imported when it is asked for."""

from __future__ import annotations

import importlib
import pkgutil

import sher3_challenge.plants as room
from sher3_challenge.errors import ChallengeError
from sher3_challenge.plants.plant import TruthPlant


def plant_names() -> tuple[str, ...]:
    """Return the names of all truth plants, sorted."""
    return tuple(sorted(module.name for module in pkgutil.iter_modules(room.__path__) if module.ispkg))


def truth_plant(name: str) -> TruthPlant:
    """Return the truth plant of a name.

    Raises:
        ChallengeError: there is none, or a library it needs is not installed.
    """
    if name not in plant_names():
        raise ChallengeError("no such plant", value=name, limit=", ".join(plant_names()))
    try:
        module = importlib.import_module(f"{room.__name__}.{name}.truth")
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("sher3_"):
            raise
        remedy = f"install {error.name}, or name other plants with --plant"
        raise ChallengeError("a plant needs a library", value=f"{name}: {error.name}", remedy=remedy) from error
    plant: TruthPlant = module.PLANT
    return plant
