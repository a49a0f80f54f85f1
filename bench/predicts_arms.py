"""Bench: what the corrected model of an arm is worth in a motion that its causes were not found in.

An arm of the ladder, with three to six causes at once, is diagnosed in one motion. Inverse dynamics of the file that
`corrected` returns then foretell the forces of another motion. Beside them stand two fits to the first motion, added to
the healthy model: all plain laws of each joint, of which none knows where the payload is, and the true causes alone.

    nice python bench/predicts_arms.py                   # 20 drawn arms
    nice python bench/predicts_arms.py --seeds 7:9       # others

An error is the rms of what is left of all joints' forces, each in units of its own force, over that of the healthy
model. Rest, where a friction may hold with any force up to its level, is left out.
"""

from __future__ import annotations

import mujoco
import numpy as np
import sher3.gap as gap
from ladder_arms import (
    LARGEST,
    METHODS,
    NOISE,
    SECONDS,
    UNIT,
    Array,
    Cause,
    asked,
    drawn_causes,
    drawn_xml,
    served,
    with_causes,
)
from predicts import Errors, rms, table
from sher3_arms.truth.world import inverse
from sher3_diagnosis.filter import low_pass
from true_arm import BAND, Motion, motion_of
from true_structure import SPREAD, STILL

ENDS = 0.5
"""Time at either end that is left out, s."""


def predicted(seed: int) -> Errors:
    """Return the errors on the second motion of a drawn arm."""
    rng = np.random.default_rng([seed, 3])
    xml = drawn_xml(rng, servo=True, joints=int(rng.integers(2, 4)), methods=METHODS[:3])
    nominal = stepped(mujoco.MjModel.from_xml_string(xml))
    causes = drawn_causes(rng, nominal.nv)
    plant = with_causes(xml, causes)
    log, first, _ = recorded(nominal, plant, rng)
    _, other, wanted = recorded(nominal, plant, rng)
    answer = gap.diagnose(xml, log)
    model = stepped(mujoco.MjModel.from_xml_string(answer.corrected().text))
    left = [low_pass(wanted - inverse(model, *other[:3]), other.period, BAND)]
    for laws in (plain_laws, lambda m: true_laws(m, causes, carried(nominal, xml, m))):
        left.append(other.left - foretold(laws(first), first, laws(other)))
    ok, size = judged(other), wanted.std(axis=0)
    errors = [rms((x / size)[ok]) for x in (*left, other.left)]
    return Errors(*(x / errors[-1] for x in errors[:-1]))


def stepped(model: mujoco.MjModel) -> mujoco.MjModel:
    """Return a model whose inverse dynamics are those of its own integrator, whose step takes part of the losses."""
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_INVDISCRETE
    return model


def recorded(nominal: mujoco.MjModel, plant: mujoco.MjModel, rng: np.random.Generator) -> tuple[dict, Motion, Array]:
    """Return the log of one motion, what it holds of motion, and the forces of the joints (n, k)."""
    stamps = np.arange(round(SECONDS / plant.opt.timestep)) * plant.opt.timestep
    ctrl = asked(rng, stamps, plant.nu) * plant.actuator_gear[:, 0]
    qpos, force = served(plant, ctrl)
    qpos = qpos + NOISE * rng.standard_normal(qpos.shape)
    log = {"time": stamps, "ctrl": ctrl, "qpos": qpos, "actuator_force": force}
    return log, motion_of(nominal, qpos, force), force * nominal.actuator_gear[:, 0]


def carried(nominal: mujoco.MjModel, xml: str, m: Motion) -> Array:
    """Return the forces (n, k) that a unit of the payload adds."""
    loaded = stepped(with_causes(xml, [Cause("payload", nominal.nv - 1, UNIT / LARGEST["payload"])]))
    return (inverse(loaded, *m[:3]) - inverse(nominal, *m[:3])) / UNIT


def plain_laws(m: Motion) -> Array:
    """Return (n, k, p) the plain laws of each joint by itself."""
    n, k = m.q.shape
    columns = [_at(x, j) for j in range(k) for x in (*_laws(m).values(), np.sin(m.q.cumsum(axis=1)), np.ones((n, k)))]
    return np.stack(columns, axis=2)


def true_laws(m: Motion, causes: list[Cause], payload: Array) -> Array:
    """Return (n, k, p) the laws of the true causes, and zeros of the joints."""
    laws = _laws(m)
    columns = [payload if c.kind == "payload" else _at(laws[c.kind], c.joint) for c in causes]
    return np.stack([*columns, *(_at(np.ones_like(m.q), j) for j in range(m.q.shape[1]))], axis=2)


def _laws(m: Motion) -> dict[str, Array]:
    soft = np.tanh(m.v / (STILL * np.abs(m.v).max(axis=0)))
    return {"viscous": m.v, "coulomb": soft, "spring": m.q, "rotor": m.a}


def _at(x: Array, joint: int) -> Array:
    out = np.zeros_like(x)
    out[:, joint] = x[:, joint]
    return out


def foretold(x: Array, first: Motion, other: Array) -> Array:
    """Return (n, k) what laws fitted to one motion say of another; both are filtered as the forces are."""
    x, other = (low_pass(c.reshape(len(c), -1), first.period, BAND).reshape(c.shape) for c in (x, other))
    ok, size = judged(first), first.left.std(axis=0)
    beta = np.linalg.lstsq((x / size[:, None])[ok], (first.left / size)[ok], rcond=None)[0]
    return np.asarray(other @ beta)


def judged(m: Motion) -> np.ndarray:
    """Return (n, k) where a joint moves, away from both ends."""
    reach = np.ones(2 * int(np.ceil(SPREAD / (BAND * m.period))) + 1)
    still = np.abs(m.v) < STILL * np.abs(m.v).max(axis=0)
    ok = np.array([np.convolve(x, reach, "same") < 0.5 for x in still.T]).T
    ends = round(ENDS / m.period)
    ok[:ends] = ok[-ends:] = False
    return ok


if __name__ == "__main__":
    table(predicted, "arms", "13000:13020", ("corrected", "all plain laws"))
