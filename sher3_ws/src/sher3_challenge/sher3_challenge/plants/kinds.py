"""Faults of a truth plant as data: a kind, a place, and the magnitude and the seed that fix it completely.

A plant registers its kinds in a `Catalogue` of its own. `apply` writes a fault into the plant's own `rig`, of which
nothing is known here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any, TypeVar

import numpy as np
from sher3_common import Sher3Error

from sher3_challenge.plants.declared import DECLARED, Row
from sher3_challenge.plants.drawn import DRAWN, Drawn, Parameters
from sher3_challenge.plants.site import Site


class FaultError(Sher3Error):
    """An unknown fault, or one on an actuator where it cannot sit."""


Apply = Callable[[Any, Site, float], Parameters]
Law = TypeVar("Law", bound=Callable[..., Any])
"""Law of a fault: rig, site and its parameters as they are drawn -> more of them that it drew itself, or nothing."""
Change = Callable[[Any, float], Any]
"""What was there, and the parameter of a fault -> what is there then."""


@dataclass(frozen=True, kw_only=True)
class Kind(Row):
    """One kind of fault of one truth plant.

    Attributes:
        name: effect id of the contract, or a name of its own outside the catalogue.
        apply: writes the fault of a magnitude into a rig; returns its parameters by the contract's names.
    """

    name: str
    apply: Apply

    @property
    def effect(self) -> str:
        """Effect id of the contract; `outside_library` for what has none."""
        if self.family == "outside":
            return "outside_library"
        return "cable_drag" if self.name.startswith("cable_drag") else self.name

    @property
    def exact(self) -> bool:
        """Whether the stage has no floor but rounding."""
        return self.stage in ("transport", "controller")


@dataclass(frozen=True)
class Fault:
    """A kind of fault at a place, with its magnitude (a slider's unit) and the seed of its shape."""

    kind: Kind
    actuator: str
    magnitude: float
    seed: int

    def apply(self, rig: Any) -> dict[str, float]:
        """Write the fault into a rig; return its parameters. Raises FaultError where its actuator cannot have it."""
        if self.actuator not in self.kind.places:
            limit = ", ".join(self.kind.places)
            raise FaultError(
                f"{self.kind.name} cannot sit there",
                value=self.actuator,
                limit=limit,
                remedy="choose one of these places",
            )
        return self.kind.apply(rig, Site(self.actuator, np.random.default_rng(self.seed)), self.magnitude)

    def scaled_by(self, factor: float) -> Fault:
        """Return the fault with its magnitude multiplied, kept between the least and the most of its kind."""
        magnitude = min(self.kind.most, max(self.kind.least, self.magnitude * factor))
        return Fault(self.kind, self.actuator, magnitude, self.seed)


class Catalogue(dict[str, Kind]):
    """Kinds of faults by name, filled by its decorators."""

    def known(self, law: Law) -> Law:
        """Register the decorated law as the kind that is declared under its name."""
        self._declared(law.__name__, law)
        return law

    def changes(self, change: Change, **values: str) -> None:
        """Register declared kinds of one parameter that change one value of the rig: name -> path of that value."""
        for name, path in values.items():
            self._declared(name, partial(_changed, path, change))

    def _declared(self, name: str, law: Callable[..., Any]) -> None:
        apply = partial(_as_drawn, law, DRAWN[name]) if name in DRAWN else law
        self[name] = Kind(**vars(DECLARED[name]), name=name, apply=apply)

    def add(
        self, family: str, stage: str, places: tuple[str, ...], start: float, least: float, most: float,
        also: tuple[str, ...] = (), company: tuple[str, ...] = (),
    ) -> Callable[[Apply], Apply]:  # fmt: skip
        """Register the decorated function as the kind of its name."""
        row = Row(family, stage, places, start, least, most, also, company)

        def register(apply: Apply) -> Apply:
            self[apply.__name__] = Kind(**vars(row), name=apply.__name__, apply=apply)
            return apply

        return register


def set_to(now: Any, value: float) -> Any:
    """Return the value, whatever was there."""
    return value


def scaled_by(now: Any, relative: float) -> Any:
    """Return what is larger by a share."""
    return now * (1 + relative)


def _changed(path: str, change: Change, rig: Any, site: Site, **drawn: float) -> None:
    """Write the one parameter of a fault into a value of the rig: its rows of an array, or a number.

    A list on the way holds an object for each actuator.
    """
    (value,) = drawn.values()
    *owners, last = path.split(".")
    owner = reduce(getattr, owners, rig)
    owner = owner[site.index] if isinstance(owner, list) else owner
    now = getattr(owner, last)
    if isinstance(now, np.ndarray):
        now[site.rows] = change(now[site.rows], value)
    else:
        setattr(owner, last, change(now, value))


def _as_drawn(law: Callable[..., Parameters | None], draw: Drawn, rig: Any, site: Site, x: float) -> Parameters:
    """Write a fault of a magnitude into a rig by its law; return its parameters."""
    drawn = draw(site, x)
    return {**drawn, **(law(rig, site, **drawn) or {})}
