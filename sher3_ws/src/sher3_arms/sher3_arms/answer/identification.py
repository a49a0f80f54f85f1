"""The usual answer beside ours: `mujoco.sysid` fits all its parameters, and the one that matters most is the cause.

Every joint has a friction loss, a damping, an armature and a gain, the last link a mass. They are fitted together on
short windows of the record, each from its recorded state and with its recorded efforts: an arm left to itself for a
minute falls. What a parameter matters is by how much the residual grows when it alone goes back to its nominal value.
"""

from __future__ import annotations

from contextlib import redirect_stdout
from importlib import import_module
from io import StringIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from sher3_common import read_text, read_yaml
from sher3_common.files.arrays import read_arrays

from sher3_arms.errors import ArmsError
from sher3_arms.files import DESCRIPTION, MODEL, RECORD

WINDOWS, LENGTH = 12, 60
"""Windows of a record, and the samples of each: a quarter of a second at 250 Hz."""
FINE = 4
"""Time steps per sample."""
ITERATIONS = 10
"""Of the optimiser at most."""
SMOOTHED = 5
"""Samples over which a velocity is taken."""
MAX_BYTES = 5_000_000
"""Largest model that is read."""
FIELDS = {
    "frictionloss": ("coulomb_friction", 0.0, 20.0),
    "damping": ("viscous_friction", 0.0, 20.0),
    "armature": ("rotor_inertia", 0.0, 5.0),
    "gain": ("torque_constant", 1.0, 2.0),
}
"""Parameter of a joint -> the effect it stands for, nominal and largest value."""
LEAST_GAIN = 0.3
"""Smallest gain."""
HEAVIEST = 20.0
"""Largest mass added to the last link, kg."""


class Identified(NamedTuple):
    """What the fit says: effect and place of the parameter that matters most, and the residual before and after."""

    effect: str
    place: str
    before: float
    after: float


def identified(folder: Path) -> Identified:
    """Fit the parameters of a sealed case's model; raises ArmsError where `mujoco.sysid` is not installed."""
    api, sysid = tools()
    names = [joint["name"] for joint in read_yaml(folder / DESCRIPTION)["joints"]]
    spec = api.MjSpec.from_string(read_text(folder / MODEL, MAX_BYTES))
    model = spec.compile()
    record = read_arrays(folder / RECORD, ("time", "position", "effort"))
    model.opt.timestep = float(record["time"][1] - record["time"][0]) / FINE
    model.opt.integrator = api.mjtIntegrator.mjINT_IMPLICITFAST
    model.jnt_limited[:] = 0
    windows = _Windows(api, model, record)
    parameters = _parameters(sysid, names)

    def residual(x: np.ndarray, at: Any) -> tuple[list[np.ndarray], None, None]:
        at.update_from_vector(np.ravel(x))
        return [windows.error({k: p.value for k, p in at.parameters.items()}, names)], None, None

    nominal = parameters.as_vector().copy()
    before = float(np.sum(residual(nominal, parameters)[0][0] ** 2))
    with redirect_stdout(StringIO()):
        best, _ = sysid.optimize(
            parameters, residual, optimizer="scipy", verbose=False, max_iters=ITERATIONS, x_scale="jac"
        )
    star = best.as_vector().copy()
    after = float(np.sum(residual(star, parameters)[0][0] ** 2))
    worth = []
    for i in range(len(star)):
        without = star.copy()
        without[i] = nominal[i]
        worth.append(float(np.sum(residual(without, parameters)[0][0] ** 2)) - after)
    key = list(parameters.parameters)[int(np.argmax(worth))]
    field, _, joint = key.partition(":")
    effect = FIELDS[field][0] if field in FIELDS else "payload_mass"
    return Identified(effect, joint or names[-1], before, after)


def tools() -> tuple[Any, Any]:
    """Return MuJoCo and `mujoco.sysid`; raises ArmsError where the latter, or a library it needs, is not installed."""
    missing = ArmsError("mujoco.sysid is not installed", remedy="install the extra: pip install 'sher3[sysid]'")
    try:
        api, sysid = import_module("mujoco"), import_module("mujoco.sysid")
    except ImportError as error:
        raise missing from error
    if not hasattr(sysid, "optimize"):  # without the libraries it needs, the module is there and empty
        raise missing
    return api, sysid


def _parameters(sysid: Any, names: list[str]) -> Any:
    """Return every parameter at its nominal value with its bounds."""
    out = {}
    for field, (_, value, most) in FIELDS.items():
        least = LEAST_GAIN if field == "gain" else 0.0
        out.update({f"{field}:{n}": sysid.Parameter(f"{field}:{n}", value, least, most) for n in names})
    out["mass"] = sysid.Parameter("mass", 0.0, 0.0, HEAVIEST)
    return sysid.ParameterDict(out)


class _Windows:
    """Stretches of a record that a model is run over from their first state."""

    def __init__(self, api: Any, model: Any, record: dict[str, np.ndarray]) -> None:
        self.api, self.model, self.data = api, model, api.MjData(model)
        self.mass = model.body_mass.copy()
        self.last = int(model.jnt_bodyid[-1])
        position, period = record["position"], float(record["time"][1] - record["time"][0])
        smooth = np.apply_along_axis(np.convolve, 0, position, np.ones(SMOOTHED) / SMOOTHED, "same")
        self.starts = np.linspace(SMOOTHED, len(position) - LENGTH - SMOOTHED, WINDOWS).astype(int)
        self.position, self.effort = position, record["effort"]
        self.velocity = np.gradient(smooth, period, axis=0)

    def error(self, values: dict[str, np.ndarray], names: list[str]) -> np.ndarray:
        """Return positions run again less the recorded ones, in the middle and at the end of every window, mrad."""
        model, data = self.model, self.data
        model.body_mass[:] = self.mass
        model.body_mass[self.last] += float(values["mass"][0])
        for j, name in enumerate(names):
            row = int(model.jnt_dofadr[j])
            model.dof_frictionloss[row] = values[f"frictionloss:{name}"][0]
            model.dof_damping[row] = values[f"damping:{name}"][0]
            model.dof_armature[row] = values[f"armature:{name}"][0]
        self.api.mj_setConst(model, data)
        gain = np.array([values[f"gain:{name}"][0] for name in names])
        out = []
        for start in self.starts:
            self.api.mj_resetData(model, data)
            data.qpos[:], data.qvel[:] = self.position[start], self.velocity[start]
            for k in range(start, start + LENGTH):
                data.qfrc_applied[:] = gain * self.effort[k]
                for _ in range(FINE):
                    self.api.mj_step(model, data)
                if k + 1 in (start + LENGTH // 2, start + LENGTH):
                    out.append(1e3 * (data.qpos - self.position[k + 1]))
        return np.concatenate(out)
