"""MuJoCo itself: a model is run over short windows, each from a recorded state, with the recorded drive."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
from types import ModuleType
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

import numpy as np
from numpy.typing import NDArray
from sher3_diagnosis.channel import Array

from sher3_export.check.recorded import Load, Recorded, Track
from sher3_export.errors import ExportError, MujocoMissing
from sher3_export.targets.mjcf.body import controlled
from sher3_export.xml_file import written

WINDOW = 0.25
"""Length of a window, s: long enough for a missing force to move a joint by many counts, short enough that a small
error of the start speed does not drown it. Set by that argument."""
MOST = 60
"""Windows of a run at most, spread over it."""
STEP = 0.001
"""Longest time step, s."""


def mujoco() -> ModuleType:
    """Return the module; raises MujocoMissing."""
    try:
        return import_module("mujoco")
    except ImportError as error:
        raise MujocoMissing from error


SERVOS = ("position", "velocity", "intvelocity", "pid", "damper")
"""Elements whose control is no force."""
DUST = 1e-9
"""Least mass, kg, and inertia, kg m^2, of a body: MuJoCo refuses one without."""


def prepared(root: Element, period: float, tracks: Mapping[str, Track]) -> Element:
    """Return a copy with a time step that divides the period, and a motor on every joint that a force drives.

    Of a joint whose force was recorded a servo is taken off: its force is in the record.
    """
    root = copied(root)
    compiler = root.find("compiler")
    compiler = SubElement(root, "compiler") if compiler is None else compiler
    for name in ("boundmass", "boundinertia"):
        compiler.set(name, compiler.get(name, written(DUST)))
    option = root.find("option")
    option = SubElement(root, "option") if option is None else option
    option.set("timestep", written(period / steps_of(period)))
    actuators = root.find("actuator")
    actuators = SubElement(root, "actuator") if actuators is None else actuators
    forced = {joint for joint, track in tracks.items() if track.drive is not None and not track.servo}
    for block in root.findall("actuator"):
        for x in [x for x in block if x.get("joint") in forced and is_servo(x)]:
            block.remove(x)
    driven = {x.get("joint") for block in root.findall("actuator") for x in block if controlled(x)}
    for joint in tracks:
        if joint not in driven:
            SubElement(actuators, "motor", {"joint": joint, "ctrllimited": "false"})
    return root


def steps_of(period: float) -> int:
    """Return the steps of the simulation in a period of a record, s."""
    return math.ceil(period / STEP - 1e-9)


def is_servo(actuator: Element) -> bool:
    """Return whether the control of an actuator is a place or a speed; of a general one its bias follows them."""
    bias = [float(x) for x in actuator.get("biasprm", "0").split()[1:]]
    return actuator.tag in SERVOS or (actuator.tag == "general" and any(bias))


def copied(root: Element) -> Element:
    """Return a copy of a model."""
    return ElementTree.fromstring(ElementTree.tostring(root))


def windows(record: Recorded) -> tuple[NDArray[np.int64], int]:
    """Return the samples (k,) at which windows start, and how many samples a window has."""
    n = len(next(iter(record.tracks.values())).position)
    length = min(n - 1, max(2, round(WINDOW / record.period)))
    return np.unique(np.linspace(1, n - length, min(MOST, max(1, (n - 1) // length))).astype(int)), length


@dataclass(frozen=True)
class Engine:
    """A compiled model and how its joints are driven.

    Attributes:
        text: of the model.
        model: the same, compiled.
        actuator: joint -> number of its actuator, and the drive for which its control is one.
    """

    text: str
    model: Any
    actuator: Mapping[str, tuple[int, float]]

    def run(self, record: Recorded, push: Mapping[str, Array] | None = None) -> dict[str, Array]:
        """Return measured less simulated position of each joint, (windows, samples), m or rad.

        The time step becomes one that divides the period of the record; what was put on in the run is on the model.

        Args:
            record: of one run.
            push: joint -> (windows,) force that acts beside the model's, constant over a window, N or N m.
        """
        if record.carried:
            loaded = replace(self, model=carrying(self.text, record.carried))
            return loaded.run(replace(record, carried=()), push)
        api = mujoco()
        data = api.MjData(self.model)
        starts, length = windows(record)
        out = {joint: np.empty((len(starts), length)) for joint in record.tracks}
        steps = steps_of(record.period)
        self.model.opt.timestep = record.period / steps
        with np.errstate(all="ignore"):
            for w, first in enumerate(starts):
                self._start(api, data, record, int(first))
                for joint, force in (push or {}).items():
                    data.qfrc_applied[self.model.jnt_dofadr[self._joint(api, joint)]] = force[w]
                for k in range(length):
                    for joint, track in record.tracks.items():
                        out[joint][w, k] = track.measured[first + k] - self._place(api, data, joint, track, int(first))
                        if track.drive is not None and joint in self.actuator:
                            number, unit = self.actuator[joint]
                            data.ctrl[number] = track.drive[first + k] / unit
                    api.mj_step(self.model, data, steps)
        return out

    def _start(self, api: ModuleType, data: Any, record: Recorded, first: int) -> None:
        api.mj_resetData(self.model, data)
        for joint, track in record.tracks.items():
            at = self._joint(api, joint)
            data.qpos[self.model.jnt_qposadr[at]] = track.position[first]
            data.qvel[self.model.jnt_dofadr[at]] = track.velocity[first]
            second = self._joint(api, f"{joint}_play", f"{joint}_spring")
            if second >= 0 and track.behind is not None:
                data.qpos[self.model.jnt_qposadr[second]] = track.behind[first] - np.median(track.behind)
            if track.drive is not None and joint in self.actuator:
                self._history(api, data, joint, track.drive, first, record.period)
        api.mj_forward(self.model, data)

    def _history(self, api: ModuleType, data: Any, joint: str, drive: Array, first: int, period: float) -> None:
        """Fill what the actuator remembers: commands of the time of its delay, and its activation."""
        number, unit = self.actuator[joint]
        samples = int(self.model.actuator_history[number][0])
        if samples:
            times = (np.arange(samples) - samples + 1) * self.model.opt.timestep - self.model.opt.timestep
            values = np.interp(first * period + times, np.arange(len(drive)) * period, drive) / unit
            api.mj_initCtrlHistory(self.model, data, number, times, np.ascontiguousarray(values[:, None]))
        act = int(self.model.actuator_actadr[number])
        if act >= 0:
            data.act[act] = drive[first] / unit

    def _place(self, api: ModuleType, data: Any, joint: str, track: Any, first: int) -> float:
        """Return the simulated position of the load, in the zero of the measured one."""
        place = float(data.qpos[self.model.jnt_qposadr[self._joint(api, joint)]])
        if track.behind is None:
            return place
        second = self._joint(api, f"{joint}_play", f"{joint}_spring")
        bent = float(data.qpos[self.model.jnt_qposadr[second]]) if second >= 0 else 0.0
        return place + bent + float(np.median(track.behind))

    def _joint(self, api: ModuleType, *names: str) -> int:
        found = [api.mj_name2id(self.model, api.mjtObj.mjOBJ_JOINT, name) for name in names]
        return max(found)


def compiled(text: str, joints: Sequence[str], gears: Mapping[str, tuple[int, float]] | None = None) -> Engine:
    """Compile a model; `gears` are those of the nominal model, so that a changed gain acts.

    Raises:
        MujocoMissing: it is not installed.
        ExportError: MuJoCo refuses the model, or it has none of the joints.
    """
    api = mujoco()
    try:
        model = api.MjModel.from_xml_string(text)
    except ValueError as error:
        raise ExportError("MuJoCo refuses the model", value=str(error)[:200], remedy="correct it") from error
    missing = [j for j in joints if api.mj_name2id(model, api.mjtObj.mjOBJ_JOINT, j) < 0]
    if missing:
        raise ExportError("the model lacks joints of the case", value=", ".join(missing), remedy="name them by --joint")
    if gears is None:
        gears = {}
        for number in range(model.nu):
            joint = api.mj_id2name(model, api.mjtObj.mjOBJ_JOINT, int(model.actuator_trnid[number][0]))
            gain = float(model.actuator_gainprm[number][0])
            if joint in joints and joint not in gears and gain:
                gear, stiffness = float(model.actuator_gear[number][0]), -float(model.actuator_biasprm[number][1])
                gears[joint] = (number, gain / (stiffness * gear) if stiffness else gain * gear)
    return Engine(text, model, gears)


def carrying(text: str, loads: Sequence[Load]) -> Any:
    """Compile a model with known masses on it: as inertia of a joint, or as a body that is fixed to a link.

    Raises:
        ExportError: the model lacks a joint or link that carries one.
    """
    spec = mujoco().MjSpec.from_string(text)
    for load in loads:
        on = spec.joint(load.on) if load.centre is None else spec.body(load.on)
        if on is None:
            remedy = "give a model by --model that calls it so"
            raise ExportError("the model lacks what `carried` names", value=load.on, remedy=remedy)
        if load.centre is None:
            on.armature += load.mass
        else:
            at = np.add(on.joints[0].pos if on.joints else 0.0, load.centre)
            inertia = {"mass": load.mass, "inertia": [DUST] * 3, "explicitinertial": True}
            on.add_body(pos=at, ipos=[0.0] * 3, iquat=[1.0, 0.0, 0.0, 0.0], **inertia)
    return spec.compile()
