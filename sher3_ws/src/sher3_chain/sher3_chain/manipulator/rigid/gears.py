"""Joints that follow others by gears, as `<mimic>` of URDF and `<equality>` of MJCF say."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.manipulator.rigid.tree import Tree


@dataclass(frozen=True)
class Geared:
    """k recorded joints with those that follow them, m together: their positions are ratios @ recorded + offsets.

    Power passes a gear whole, so the recorded joint feels the force of a follower times its ratio.

    Attributes:
        names: the recorded joints, then the followers, (m,).
        ratios: (m, k).
        offsets: (m,), rad or m.
    """

    names: tuple[str, ...]
    ratios: Array
    offsets: Array

    def places(self, q: Array) -> Array:
        """Return the positions of all, (n, m), of recorded ones (n, k)."""
        return self.moving(q) + self.offsets

    def moving(self, x: Array) -> Array:
        """Return velocities or accelerations of all, (n, m), of recorded ones (n, k)."""
        return np.asarray(x) @ self.ratios.T

    def felt(self, forces: Array) -> Array:
        """Return what the recorded joints feel, (n, k, ...), of forces of all, (n, m, ...)."""
        if len(self.names) == self.ratios.shape[1]:
            return forces
        return np.einsum("nm...,mk->nk...", forces, self.ratios)


def geared(tree: Tree, names: Sequence[str]) -> Geared:
    """Return recorded joints with those of a tree that follow them."""
    followers = tree.followers(names)
    ratios = [[gear.ratio * (name == gear.leader) for name in names] for gear in followers.values()]
    offsets = [0.0] * len(names) + [gear.offset for gear in followers.values()]
    every = np.vstack([np.eye(len(names)), *(np.array([row]) for row in ratios)])
    return Geared((*names, *followers), every, np.array(offsets))
