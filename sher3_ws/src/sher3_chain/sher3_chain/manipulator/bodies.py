"""The model of an arm before its joints are chosen: rigid bodies, and the `MjModel` where it is one of MuJoCo."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from sher3_common import FileError, read_text
from sher3_machines.errors import MachineError

from sher3_chain.manipulator.mjcf.bodies import tree_from_mjcf
from sher3_chain.manipulator.mjcf.drives import Driven, driven
from sher3_chain.manipulator.mjcf.reading import BINARY, MAX_BYTES, binary, compiled, is_mjcf
from sher3_chain.manipulator.rigid.tree import Tree
from sher3_chain.manipulator.rigid.urdf import tree_from_urdf


@dataclass(frozen=True)
class Bodies:
    """A model of an arm.

    Attributes:
        label: path or name, for errors.
        tree: all bodies and joints.
        mujoco: `MjModel` of an MJCF file; None for a URDF.
    """

    label: str
    tree: Tree
    mujoco: Any = None

    @property
    def joints(self) -> dict[str, bool]:
        """Joint -> whether it slides, of every joint that turns or slides, in the model's order."""
        return {link.name: link.slides for link in self.tree.links}

    @property
    def reach(self) -> dict[str, float]:
        """Joint -> largest angle that the model allows, rad, of those that turn; infinite where it states none."""
        return {link.name: link.reach for link in self.tree.links if not link.slides}

    def follow(self, names: Sequence[str], guesses: list[str]) -> set[str]:
        """Return those of recorded joints that follow another of them by a gear, and say so of all that do.

        They are moved by the joint that they follow, which feels their force; what was recorded of them is not used.
        """
        led = {n for n in names if n in self.tree.followers(set(names) - {n})}
        found = self.tree.followers([n for n in names if n not in led])
        guesses += [
            f"{name} follows {gear.leader}: {gear.ratio:.4g} times its place"
            + (f" {gear.offset:+.4g}" if gear.offset else "")
            + ", and its force is felt there; take that out of the model where it has a motor of its own"
            for name, gear in found.items()
        ]
        return led

    def at_rest(self, names: Collection[str], guesses: list[str]) -> None:
        """Say which joints neither were recorded nor follow one that was."""
        left = [name for name in self.joints if name not in {*names, *self.tree.followers(names)}]
        if left:
            guesses.append(f"joints that were not recorded stay at zero: {', '.join(left)}")

    @cached_property
    def drives(self) -> dict[str, Driven]:
        """Joint -> how the model drives it; nothing of a URDF, which has no drives."""
        return {} if self.mujoco is None else driven(self.mujoco)


def read_bodies(path: Path) -> Bodies:
    """Read a URDF, MJCF or binary file of MuJoCo (.mjb); raises MachineError where it cannot be read."""
    if path.suffix == BINARY:
        return bodies_of_mujoco(binary(path), str(path))
    try:
        return bodies_of(read_text(path, MAX_BYTES), str(path), path)
    except FileError as error:
        remedy = "give a URDF or MJCF file"
        raise MachineError(f"{path}: cannot be read", value=str(error)[:120], remedy=remedy) from error


def bodies_of(text: str, label: str, path: Path | None = None) -> Bodies:
    """Return the model of a text, URDF or MJCF.

    Args:
        text: of the file.
        label: that errors name.
        path: of the file, beside which meshes are; None: the text stands alone.

    Raises:
        MachineError: MuJoCo is missing, the text cannot be read, or a joint of an MJCF neither turns nor slides.
    """
    if "<!DOCTYPE" in text:  # what declares entities can expand without bound or name other files
        raise MachineError(f"{label}: has a document type", value="<!DOCTYPE", remedy="give a plain file")
    if is_mjcf(text):
        return bodies_of_mujoco(compiled(text, label, path), label)
    return Bodies(label, tree_from_urdf(text, label))


def bodies_of_mujoco(model: Any, label: str) -> Bodies:
    """Return an `MjModel`; raises MachineError where a joint neither turns nor slides."""
    return Bodies(label, tree_from_mjcf(model, label), model)
