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
from sher3_diagnosis.quantify.jackknife import standard_error
from sher3_diagnosis.thresholds import JACKKNIFE
from sher3_diagnosis.verdict import Identified, Parameter
from sher3_effects.page import CONSTANTS
from sher3_machines.thresholds import BLOCKS

from sher3_chain.manipulator.description import Joint
from sher3_chain.manipulator.identification.gains import friction_columns
from sher3_chain.manipulator.model import PARAMETERS, ROUNDED, ArmModel
from sher3_chain.manipulator.view import MotionView

LINK = tuple(name for name in CONSTANTS if name.startswith("link_"))
"""Constants of a link, in the order of its inertial parameters."""
ROTOR = "inertia"
"""Constant of a joint: its rotor."""
UNITS = ("kg", *["kg*m"] * 3, *["kg*m^2"] * 6)
"""Of these constants."""
ALONE = 1e-6
"""Share of a number, squared, outside what the motion determines, below which it is determined by itself: rounding."""
UNSEEN = 1e-3
"""Singular value, as a share of the largest, below which the motion does not determine a combination of parameters."""


class Inertias(NamedTuple):
    """What an arm's inertias have beyond its model.

    Attributes:
        links: parameters of all links, (10 links,), kg, kg m, kg m^2.
        rotors: of all recorded joints, or of the motors behind a coupling, (k,), kg or kg m^2.
        rotor_errors, link_errors: standard errors of both, infinite of a number that the motion tells in sums alone.
    """

    links: Array
    rotors: Array
    rotor_errors: Array
    link_errors: Array

    def model(self, nominal: ArmModel) -> ArmModel:
        """Return the model with these links."""
        return replace(nominal, parameters=nominal.inertial + self.links)

    def at(self, joints: Sequence[Joint]) -> list[Joint]:
        """Return the joints with these rotors, which take force by acceleration as a simulator's step does."""
        each = zip(joints, self.rotors, strict=True)
        return [j.model_copy(update={"step_inertia": j.step_inertia + float(x)}) for j, x in each]

    def by_place(self, model: ArmModel) -> list[Identified]:
        """Return them by place, as a verdict has them."""
        links = [
            dict(zip(LINK, map(_parameter, value, error, UNITS), strict=True))
            for value, error in zip(*(x.reshape(-1, PARAMETERS) for x in (self.links, self.link_errors)), strict=True)
        ]
        units = ["kg" if slides else "kg*m^2" for slides in model.linear]
        rotors = [{ROTOR: p} for p in map(_parameter, self.rotors, self.rotor_errors, units)]
        places = zip((*model.links, *model.names), [*links, *rotors], strict=True)
        return [Identified(actuator=place, constants=constants) for place, constants in places]


def _parameter(value: float, error: float, unit: str) -> Parameter:
    """Return a number with its 95 % interval, where it has one."""
    half = JACKKNIFE * error
    low, high = (float(value - half), float(value + half)) if np.isfinite(half) else (None, None)
    return Parameter(value=float(value), low=low, high=high, unit=unit)


def identified_inertias(views: Sequence[MotionView], model: ArmModel, judged: Sequence[str]) -> Inertias:
    """Return the inertial parameters and rotors that explain the efforts of all joints best, beyond the model's.

    Args:
        views: of all records.
        model: nominal.
        judged: joints whose effort was recorded.
    """
    x, y, block = _equations(views, judged)
    links, own = len(model.inertial), (x.shape[1] - len(model.inertial)) // len(judged)
    columns = {name: links + i * own for i, name in enumerate(judged)}
    stated = {columns[name]: rotor for name, rotor in zip(model.names, model.rotors, strict=True) if name in columns}
    step, error = _shortest(x, y, block, stated)
    rotors = [(step[columns[n]], error[columns[n]]) if n in columns else (0.0, np.inf) for n in model.names]
    own_step, own_error = np.array(rotors).T
    return Inertias(step[:links], own_step, own_error, error[:links])


def _equations(views: Sequence[MotionView], judged: Sequence[str]) -> tuple[Array, Array, Array]:
    """Return columns of all links and, for each joint, of rotor and friction; what the model leaves of efforts; blocks.

    A block is the same part of every record for all joints.
    """
    rows, target, blocks = [], [], []
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
            blocks.append(np.flatnonzero(ok) * BLOCKS // len(ok))
    return np.concatenate(rows), np.concatenate(target), np.concatenate(blocks)


def _shortest(x: Array, y: Array, block: Array, stated: Mapping[int, float]) -> tuple[Array, Array]:
    """Return the shortest step (p,) that explains y best and leaves no rotor below zero, and its standard error (p,).

    The error is that of a jackknife over blocks of the rows; infinite where the columns do not tell a number alone.

    Args:
        x: columns, (n, p); one that rounding leaves of nothing stays.
        y: (n,).
        block: of each row, (n,).
        stated: column of a rotor -> what the model says of it.
    """
    length = np.linalg.norm(x, axis=0)
    alive, step = length > ROUNDED * length.max(), np.zeros(x.shape[1])
    while True:
        rest = y - x[:, ~alive] @ step[~alive]
        scaled = x[:, alive] / length[alive]
        _, size, turned = np.linalg.svd(np.linalg.qr(scaled, mode="r"))
        seen = turned[size > UNSEEN * size[0]]
        step[alive] = seen.T @ np.linalg.lstsq(scaled @ seen.T, rest, rcond=None)[0] / length[alive]
        below = [i for i, rotor in stated.items() if alive[i] and step[i] < -rotor]
        if not below:
            break
        alive[below] = False
        step[below] = [-stated[i] for i in below]
    error = np.full(len(step), np.inf)
    alone = 1.0 - np.sum(seen**2, axis=0) < ALONE
    without = [np.linalg.lstsq((scaled @ seen.T)[block != k], rest[block != k], rcond=None)[0] for k in range(BLOCKS)]
    error[alive] = np.where(alone, standard_error(np.array(without) @ seen) / length[alive], np.inf)
    return step, error


def _spread(views: Sequence[MotionView], joint: str) -> float:
    """Return the standard deviation of a joint's effort over all records: what it errs by differs by joint alone.

    Records are not brought to one size: near a resonance inertia and weight cancel, and a small effort is their error.
    """
    found = [view.effort[view.in_motion(view.row(joint)), view.row(joint)] for view in views]
    return max(float(np.std(np.concatenate(found))), np.finfo(float).tiny)
