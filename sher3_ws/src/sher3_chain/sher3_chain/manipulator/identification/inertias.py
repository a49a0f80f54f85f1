"""Inertial parameters and rotors found from the data, beside the usual friction of every joint.

Inverse-dynamics identification (Gautier and Khalil; Janot et al.): efforts = regressor * parameters + rotor *
acceleration + friction, all joints together. What the motion does not tell stays as the model has it: the step from the
model's numbers is the shortest one that explains the efforts, which changes base parameters alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from sher3_diagnosis.channel import Array
from sher3_diagnosis.verdict import Identified, Parameter
from sher3_effects.page import CONSTANTS

from sher3_chain.manipulator.description import Joint
from sher3_chain.manipulator.identification.gains import friction_columns
from sher3_chain.manipulator.model import PARAMETERS, ROUNDED, ArmModel
from sher3_chain.manipulator.view import MotionView

LINK = tuple(name for name in CONSTANTS if name.startswith("link_"))
"""Constants of a link, in the order of its inertial parameters."""
ROTOR = "inertia"
"""Constant of a joint: its rotor."""
UNITS = dict(zip(LINK, ("kg", *["kg*m"] * 3, *["kg*m^2"] * 6), strict=True))
UNSEEN = 1e-3
"""Singular value, as a share of the largest, below which the motion does not determine a combination of parameters."""


class Inertias(NamedTuple):
    """What an arm's inertias have beyond its model.

    Attributes:
        links: parameters of all links, (10 links,), kg, kg m, kg m^2.
        rotors: of all recorded joints, or of the motors behind a coupling, (k,), kg or kg m^2.
    """

    links: Array
    rotors: Array

    def model(self, nominal: ArmModel) -> ArmModel:
        """Return the model with these links."""
        return replace(nominal, parameters=nominal.inertial + self.links)

    def at(self, joints: Sequence[Joint]) -> list[Joint]:
        """Return the joints with these rotors, which take force by acceleration as a simulator's step does."""
        each = zip(joints, self.rotors, strict=True)
        return [j.model_copy(update={"step_inertia": j.step_inertia + float(x)}) for j, x in each]

    def told(self, model: ArmModel) -> list[Identified]:
        """Return them by place, as a verdict has them."""
        links = zip(model.links, self.links.reshape(-1, PARAMETERS), strict=True)
        rotors = zip(model.names, model.linear, self.rotors, strict=True)
        return [
            *(_identified(link, dict(zip(LINK, own, strict=True)), UNITS) for link, own in links),
            *(_identified(joint, {ROTOR: x}, {ROTOR: "kg" if slides else "kg*m^2"}) for joint, slides, x in rotors),
        ]


def _identified(place: str, own: Mapping[str, float], units: Mapping[str, str]) -> Identified:
    each = {name: Parameter(value=float(x), unit=units[name]) for name, x in own.items()}
    return Identified(actuator=place, constants=each)


def identified_inertias(views: Sequence[MotionView], model: ArmModel, judged: Sequence[str]) -> Inertias:
    """Return the inertial parameters and rotors that explain the efforts of all joints best, beyond the model's.

    Args:
        views: of all records.
        model: nominal.
        judged: joints whose effort was recorded.
    """
    x, y = _equations(views, judged)
    links, own = len(model.inertial), (x.shape[1] - len(model.inertial)) // len(judged)
    columns = {name: links + i * own for i, name in enumerate(judged)}
    stated = {columns[name]: rotor for name, rotor in zip(model.names, model.rotors, strict=True) if name in columns}
    step = _shortest(x, y, stated)
    return Inertias(step[:links], np.array([step[columns[name]] if name in columns else 0.0 for name in model.names]))


def _equations(views: Sequence[MotionView], judged: Sequence[str]) -> tuple[Array, Array]:
    """Return columns of all links and, for each joint, of rotor and friction; and what the model leaves of efforts."""
    rows, target = [], []
    for place, joint in enumerate(judged):
        scale = _spread(views, joint)
        for view in views:
            row, ok = view.row(joint), view.in_motion(view.row(joint))
            friction = friction_columns(view, joint)[ok, :2]  # a constant force would take the weight
            alone = np.column_stack([view.acceleration[ok, row], friction])
            own = np.zeros((len(alone), len(judged), alone.shape[1]))
            own[:, place] = alone
            rows.append(np.hstack([view.regressor[ok, row], own.reshape(len(own), -1)]) / scale)
            target.append((view.effort[ok, row] - view.rigid[ok, row]) / scale)
    return np.concatenate(rows), np.concatenate(target)


def _shortest(x: Array, y: Array, stated: Mapping[int, float]) -> Array:
    """Return the shortest step (p,) that explains y best and leaves no rotor below zero.

    Args:
        x: columns, (n, p); one that rounding leaves of nothing stays.
        y: (n,).
        stated: column of a rotor -> what the model says of it.
    """
    length = np.linalg.norm(x, axis=0)
    alive, step = length > ROUNDED * length.max(), np.zeros(x.shape[1])
    while True:
        rest = y - x[:, ~alive] @ step[~alive]
        step[alive] = np.linalg.lstsq(x[:, alive] / length[alive], rest, rcond=UNSEEN)[0] / length[alive]
        below = [i for i, rotor in stated.items() if alive[i] and step[i] < -rotor]
        if not below:
            return step
        alive[below] = False
        step[below] = [-stated[i] for i in below]


def _spread(views: Sequence[MotionView], joint: str) -> float:
    """Return the standard deviation of a joint's effort over all records: what it errs by differs by joint alone.

    Records are not brought to one size: near a resonance inertia and weight cancel, and a small effort is their error.
    """
    found = [view.effort[view.in_motion(view.row(joint)), view.row(joint)] for view in views]
    return max(float(np.std(np.concatenate(found))), np.finfo(float).tiny)
