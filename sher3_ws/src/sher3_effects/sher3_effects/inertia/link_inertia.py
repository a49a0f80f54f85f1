"""Link inertia: the inertial parameters of a link that its model has wrong, whichever of them the motion tells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.effect import Best, Measured, Shape, Signature

from sher3_effects.page import Page
from sher3_effects.view import ArmMotionView


class LinkInertia(Page):
    """F = regressor * (change of mass, mass times centre and inertia), of those that the motion tells of a link.

    Rigid bodies' equations are linear in the ten inertial parameters of a link. What other links may as well have is
    regrouped on the link that is taken first (base parameters; Gautier and Khalil 1990), so that a single number is
    the change of a sum and no property of one body.
    """

    id, family, stage = "link_inertia", "inertia", "motor_mechanics"
    inputs = ("acceleration", "weight", "posture")
    scales = "weight"
    kinds: ClassVar[tuple[str, ...]] = ("joint",)
    places = ("link",)
    best = Best("steps", "accelerations separate mass from weight")
    explanation = (
        "Mass, centre or inertia of a link are not as the model says: weight and inertia on every joint that carries "
        "it, in every posture as one rigid body needs them. Changes of several links that act alike are told as one."
    )
    siblings = {
        "link_mass": "mass and inertia off by one share, with the centre as modelled",
        "payload_mass": "a body that is only added",
        "cable_torque": "one joint alone, by its own position, whatever the posture of the others",
    }
    NAMES = ("mass", "mx", "my", "mz", "ixx", "ixy", "iyy", "ixz", "iyz", "izz")
    """Inertial parameters of a link about its joint, as Pinocchio orders them."""
    gives = NAMES
    on_axis: ClassVar[Mapping[str, str]] = {name: f"link_{name}" for name in NAMES}
    MOMENTS = ("mx", "my", "mz")
    units: ClassVar[Mapping[str, str]] = {
        "mass": "kg",
        **dict.fromkeys(MOMENTS, "kg*m"),
        **dict.fromkeys(("ixx", "ixy", "iyy", "ixz", "iyz", "izz"), "kg*m^2"),
        "change": "kg*m",
    }

    discrete = frozenset({"change", *NAMES})
    """They are found over all joints at once, each counting alike, before the causes of single joints are."""
    ERROR = "_error"
    """What the name of a standard error ends with in a shape."""

    def shapes(self, views: Sequence[Any], site: str) -> list[Shape]:
        """Return none: what the motion tells of a link, beside the others, is found over the whole arm."""
        return []

    def free(self) -> FreeLinkInertia | None:
        """Return the same law with a coefficient for each parameter that a shape names."""
        return FreeLinkInertia()

    def found(self, each: Mapping[str, Measured]) -> Shape:
        """Return the shape of parameters with their values and standard errors."""
        return {**super().found(each), **{name + self.ERROR: x.error for name, x in each.items()}}

    def numbers(self, shape: Shape) -> dict[str, float]:
        """Return the parameters that a shape names."""
        return {name: shape[name] for name in self.NAMES if name in shape}

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return, without a coefficient, what the found changes ask of every joint that carries the link."""
        changes = np.array(list(self.numbers(shape).values()))
        return Signature(fixed={c: x @ changes for c, x in self.forces(view, site, shape).items()})

    def forces(self, view: Any, site: str, shape: Shape) -> dict[Channel, Array]:
        """Return on every joint that carries the link the force (g, 1, p) per unit of the p parameters of the shape."""
        arm: ArmMotionView = view
        columns = [self.NAMES.index(name) for name in self.numbers(shape)]
        return {Channel(self.stage, joint): x[:, None, columns] for joint, x in arm.per_inertial(site).items()}

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        """Return the change of mass times centre [kg m], and every number of the shape; coefficients (p,) add none."""
        each = self.numbers(shape)
        moments = [each[name] for name in self.MOMENTS if name in each]
        return {**({"change": float(np.linalg.norm(moments))} if moments else {}), **each}

    def measured(self, views: Sequence[Any], site: str, shape: Shape) -> Mapping[str, Measured]:
        """Return every number with its standard error over parts of the records."""
        each = {n: Measured(x, shape[n + self.ERROR]) for n, x in self.numbers(shape).items()}
        moments = [each[name] for name in self.MOMENTS if name in each]
        if not moments:
            return each
        size = float(np.linalg.norm([m.value for m in moments]))
        error = float(np.linalg.norm([m.value * m.error for m in moments])) / size if size else 0.0
        return {"change": Measured(size, error), **each}


class FreeLinkInertia(LinkInertia):
    """The same with a coefficient for each parameter, by which they are found."""

    kinds = ()

    def free(self) -> None:
        """Return None: this page is the free law itself."""

    def signature(self, view: Any, site: str, shape: Shape) -> Signature:
        """Return a column for each parameter."""
        return Signature(self.forces(view, site, shape))
