"""Links whose inertial parameters are wrong: changes are gathered, and written together as bodies that can exist."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element, tostring

import numpy as np
from sher3_chain.manipulator.bodies import bodies_of
from sher3_chain.manipulator.rigid.physical import physical
from sher3_chain.manipulator.rigid.tree import MATRIX, PARAMETERS, SIX, Tree, moved
from sher3_diagnosis.channel import Array
from sher3_effects.page import CONSTANTS
from sher3_machines.errors import MachineError

from sher3_export.changes import Change
from sher3_export.targets.target import Row

INERTIAL = tuple(name for name in CONSTANTS if name.startswith("link_"))
"""Constants of a link, in the order of its inertial parameters."""
WANTED = Row("inertial", lambda to, change, link: to.links.want(change))
"""How a target that has `links` takes each of them."""
MOVED = 1e-6
"""Share of the mean mass, with lengths in metres, by which a body must change to be written anew."""
NAMES = ("ixx", "ixy", "iyy", "ixz", "iyz", "izz")
ALIKE = (
    "Motion tells sums over links. Those of single links are of the bodies that can exist, move alike and are next to "
    "the model's: no number of one of them is known by itself, but for identified ones that have an interval."
)


class Inertia(NamedTuple):
    """Of a body in its own frame.

    Attributes:
        mass: kg.
        centre: of mass, (3,), m.
        about: that centre, kg m^2, by `NAMES`.
    """

    mass: float
    centre: Array
    about: Mapping[str, float]


class WrongLinks:
    """Changes of the links of a model.

    Attributes:
        root: of the model; it is read anew when the changes are written.
        bare: what of a model its bodies are read from.
    """

    def __init__(self, root: Element, bare: Callable[[Element], Element] = lambda root: root) -> None:
        self.root = root
        self.bare = bare
        self._wanted: dict[str, Array] = {}

    def want(self, change: Change) -> str:
        """Take a change; return why it cannot be written, or nothing."""
        if not self._wanted and (reason := self._unreadable_inertias()):
            return reason
        self._wanted.setdefault(change.joint, np.zeros(PARAMETERS))[INERTIAL.index(change.constant)] += change.value
        return ""

    def changed(self) -> dict[str, Inertia]:
        """Return body -> what it must be, of those that change."""
        if not self._wanted:
            return {}
        tree = self._tree()
        names = [link.body or link.name for link in tree.links]
        change = np.array([self._wanted.get(name, np.zeros(PARAMETERS)) for name in names])
        places = np.array([i for i, link in enumerate(tree.links) if link.body])
        own = np.array([tree.links[i].own for i in places])
        found = physical(tree, own, change, places)
        least = MOVED * float(np.mean(own[:, 0]))
        both = zip(places, found, np.abs(found - own).max(axis=1), strict=True)
        return {tree.links[i].body: _inertia(moved(x, np.eye(3), -tree.links[i].at)) for i, x, by in both if by > least}

    def remarks(self) -> Sequence[str]:
        """Return what a reader of the model must know."""
        return [ALIKE] if self._wanted else []

    def _tree(self) -> Tree:
        return bodies_of(tostring(self.bare(self.root), encoding="unicode"), "the model").tree

    def _unreadable_inertias(self) -> str:
        compiler = self.root.find("compiler")
        if compiler is not None and compiler.get("inertiafromgeom") == "true":
            return "the compiler of the model takes all inertias from its geoms: take inertiafromgeom out"
        try:
            self._tree()
        except MachineError as error:
            return f"the bodies of the model cannot be read: {error.value or error.what}; give each an <inertial>"
        return ""


def _inertia(inertial: Array) -> Inertia:
    mass, centre = float(inertial[0]), inertial[1:4] / inertial[0]
    about = inertial[4:][np.array(MATRIX)] - mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
    return Inertia(mass, centre, dict(zip(NAMES, about[SIX], strict=True)))
