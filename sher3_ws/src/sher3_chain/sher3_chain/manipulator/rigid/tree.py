"""Rigid bodies in a tree: each joint turns about or slides along one axis, and carries what is fixed behind it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array

WORLD = -1
"""Number of the parent of a joint on the base."""
PARAMETERS = 10
"""Inertial parameters of a body: mass, mass times centre (3), inertia about its joint (xx xy yy xz yz zz)."""
MATRIX = ((0, 1, 3), (1, 2, 4), (3, 4, 5))
"""Which of the last six stands in each place of the inertia's matrix."""
SIX = ((0, 0, 1, 0, 1, 2), (0, 1, 1, 2, 2, 2))
"""Rows and columns of the matrix in which the six stand."""


class Gear(NamedTuple):
    """By what a joint follows another: its position is `ratio` times that of the `leader`, plus `offset`, rad or m."""

    leader: str
    ratio: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Link:
    """A joint and what it carries.

    Attributes:
        name: of the joint.
        body: first body that it moves; empty: none of its own.
        parent: number of the joint before it, or WORLD.
        turn, place: orientation (3, 3) and origin (3,), m, of the joint's frame in its parent's, at position zero.
        axis: unit vector in the joint's frame, (3,).
        slides: whether it slides.
        inertia: inertial parameters of what it carries, (10,), kg, kg m, kg m^2, in the joint's frame.
        own: those of the first body alone.
        at: origin of that body in the joint's frame, (3,), m; both have the same axes.
        rotor: inertia of the drive at the joint, kg m^2 or kg.
        low, high: positions at which its stops begin to act, rad or m; infinite without a stop.
        gear: by which it follows another joint; None: it follows none.
    """

    name: str
    body: str
    parent: int
    turn: Array
    place: Array
    axis: Array
    slides: bool
    inertia: Array = field(default_factory=lambda: np.zeros(PARAMETERS))
    own: Array = field(default_factory=lambda: np.zeros(PARAMETERS))
    at: Array = field(default_factory=lambda: np.zeros(3))
    rotor: float = 0.0
    low: float = -np.inf
    high: float = np.inf
    gear: Gear | None = None

    @property
    def reach(self) -> float:
        """Largest position that the model allows, rad or m."""
        return max(abs(self.low), abs(self.high))

    def carrying(self, inertia: Array, turn: Array, place: Array, body: str) -> Link:
        """Return the link with one more body.

        Args:
            inertia: parameters (10,) in the frame of the body.
            turn: (3, 3) rotation of that frame in the joint's frame.
            place: (3,) its origin, m.
            body: name.
        """
        added = moved(inertia, turn, place)
        more = replace(self, inertia=self.inertia + added)
        return more if self.body else replace(more, body=body, own=added, at=place)


@dataclass(frozen=True)
class Tree:
    """All joints of a machine, parents before children.

    Attributes:
        links: the joints that turn or slide.
        gravity: m/s^2, (3,).
        other: joint -> its kind, of those that neither turn nor slide; they are held at zero.
    """

    links: tuple[Link, ...]
    gravity: Array
    other: Mapping[str, str] = field(default_factory=dict)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        return tuple(link.name for link in self.links)

    @property
    def inertial(self) -> Array:
        """Inertial parameters of all links, (10 links,)."""
        return np.concatenate([link.inertia for link in self.links])

    def followers(self, names: Collection[str]) -> dict[str, Gear]:
        """Return the other joints that follow one of these, directly or through others, each with its whole gear."""
        others = {link.name: link.gear for link in self.links if link.gear is not None and link.name not in names}
        found = {}
        for name, gear in others.items():
            for _ in others:  # at most as often as there are gears: they may form a circle
                if further := others.get(gear.leader):
                    gear = Gear(further.leader, gear.ratio * further.ratio, gear.ratio * further.offset + gear.offset)
            if gear.leader in names:
                found[name] = gear
        return found

    def only(self, names: Collection[str]) -> Tree:
        """Return the tree in which all joints but these are held at zero."""
        kept: list[Link] = []
        carriers: list[tuple[int, Array, Array]] = []
        for link in self.links:
            parent, turn, place = (WORLD, np.eye(3), np.zeros(3)) if link.parent == WORLD else carriers[link.parent]
            place, turn = place + turn @ link.place, turn @ link.turn
            if link.name in names:
                carriers.append((len(kept), np.eye(3), np.zeros(3)))
                kept.append(replace(link, parent=parent, turn=turn, place=place))
                continue
            carriers.append((parent, turn, place))
            if parent != WORLD:
                kept[parent] = kept[parent].carrying(link.inertia, turn, place, link.body)
        return replace(self, links=tuple(kept))


def parameters(mass: float, centre: Array, inertia: Array) -> Array:
    """Return the inertial parameters (10,) of a body.

    Args:
        mass: kg.
        centre: of mass, m, (3,).
        inertia: about that centre, kg m^2, (3, 3).
    """
    about = inertia + mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return np.array([mass, *(mass * centre), *about[SIX]])


def moved(inertial: Array, turn: Array, place: Array) -> Array:
    """Return the inertial parameters (10,) of a body in another frame (Featherstone 2008, section 2.13).

    Args:
        inertial: (10,) in the frame of the body.
        turn: (3, 3) rotation of that frame in the other one.
        place: (3,) its origin there, m.
    """
    mass, moment = inertial[0], turn @ inertial[1:4]
    about = turn @ inertial[4:][np.array(MATRIX)] @ turn.T
    double = np.outer(place, moment) + np.outer(moment, place) + mass * np.outer(place, place)
    about = about + np.trace(double) * np.eye(3) - double
    return np.array([mass, *(moment + mass * place), *about[SIX]])
