"""The truth plants there are: the folders beside this file. A plant is imported when it is asked for."""

from __future__ import annotations

import importlib
import pkgutil

from sher3_common.progress import Say

import sher3_challenge.plants as room
from sher3_challenge.errors import ChallengeError
from sher3_challenge.plants.plant import TruthPlant

EXTRAS = {"mujoco": "sher3[mujoco]"}
"""Libraries that only a plant needs, and what installs them."""


class MissingLibraryError(ChallengeError):
    """A truth plant needs a library that is not installed; carries `plant` and `library`."""

    def __init__(self, plant: str, library: str) -> None:
        wanted = f"install the extra: pip install '{EXTRAS[library]}'" if library in EXTRAS else f"install {library}"
        remedy = f"{wanted}, or name other plants with --plant"
        super().__init__("a plant needs a library", value=f"{plant}: {library}", remedy=remedy)
        self.plant, self.library = plant, library


def plant_names() -> tuple[str, ...]:
    """Return the names of all truth plants, sorted."""
    return tuple(sorted(module.name for module in pkgutil.iter_modules(room.__path__) if module.ispkg))


def truth_plant(name: str) -> TruthPlant:
    """Return the truth plant of a name.

    Raises:
        ChallengeError: there is none, or a library it needs is not installed.
    """
    if name not in plant_names():
        raise ChallengeError.unknown("no such plant", name, plant_names())
    try:
        module = importlib.import_module(f"{room.__name__}.{name}.truth")
    except ModuleNotFoundError as error:
        if (error.name or "").startswith("sher3_"):
            raise
        raise MissingLibraryError(name, error.name or "") from error
    plant: TruthPlant = module.PLANT
    return plant


def truth_plants(say: Say) -> list[TruthPlant]:
    """Return every truth plant whose libraries are installed; `say` is told what is left out and why."""
    found = []
    for name in plant_names():
        try:
            found.append(truth_plant(name))
        except MissingLibraryError as error:
            say(f"without plant {error.plant}: {error}")
    return found
