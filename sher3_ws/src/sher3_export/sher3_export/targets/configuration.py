"""Actuator configurations in Python: a group for each joint with the fields of a library, and the range of each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

from sher3_effects.page import NOISE

from sher3_export.changes import Change
from sher3_export.targets.target import Target, XmlTarget

DELAYS = ("delay", "servo_delay")
"""Constants that a group counts in physics steps: it gives a command, or a reference, so many of them late."""
STEP = 0.005
"""Physics step, s, in which a delay is counted where the model states none; the file says so. Isaac Lab's tasks run at
200 Hz; mjlab runs at the step of the simulation's own configuration."""
ALONE = "Values are what the machine has beyond its model: add what your asset has, or give --model."
NO_GAINS = "the gains are not known here: give --model with position actuators, or multiply them by one plus this"
GAINS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("drive", "servo"), ("stiffness", "damping")),
    "servo_position": ("stiffness",),
    "servo_velocity": ("damping",),
}
"""Constant of a servo -> gains that it scales."""
OF_READINGS: Mapping[str, str] = dict.fromkeys(NOISE, "NOISE, of the file")
"""Constants of which no actuator has a field: they are for the noise of observations, by joint."""
OF_GAINS = {constant: ", ".join(names) for constant, names in GAINS.items()}
"""The same as text."""


class Configuration(Target):
    """A Python file with `ACTUATORS`, by joint, `RANGES`, by joint and field, and `NOISE`, by joint and reading.

    Class attributes:
        source: module that has the classes.
        plain, delayed: class of a group, without and with a delay.
        servo: class of a group whose gains are stated; empty: the same.
        joints: field that names the joints, and the type of its list as written.
        delays: fields of the shortest and the longest delay, steps.
        always: fields that a group states anyway.
        version: of the library whose fields these are.
    """

    suffix = "py"
    source: ClassVar[str]
    plain: ClassVar[str]
    delayed: ClassVar[str]
    servo: ClassVar[str] = ""
    joints: ClassVar[str]
    delays: ClassVar[tuple[str, str]]
    always: ClassVar[Mapping[str, object]] = {}
    version: ClassVar[str]

    def __init__(self, model: XmlTarget | None = None) -> None:
        self.nominal = None if model is None else model.nominal()
        self.step = STEP if model is None else model.step or STEP
        self.groups: dict[str, dict[str, float]] = {}
        self.ranges: dict[str, dict[str, tuple[float, float]]] = {}
        self.noise: dict[str, dict[str, float]] = {}

    def apply(self, change: Change) -> str:
        """Write a change into the group of its joint; return why it cannot be written, or nothing."""
        if change.over_stiffness:
            return "given in units of the servo's stiffness, which is not known here"
        if change.constant not in self.fields:
            return self.refuses.get(change.constant, f"{self.name} has no field for it")
        if change.constant in NOISE:
            self.noise.setdefault(change.joint, {})[change.constant] = change.value
            return ""
        group, ranges = self.groups.setdefault(change.joint, {}), self.ranges.setdefault(change.joint, {})
        if change.constant in DELAYS:
            shortest, longest = self.delays
            group |= {shortest: math.floor(change.value / self.step), longest: math.ceil(change.value / self.step)}
            return ""
        if change.constant in GAINS:
            return self._scale(change, group, ranges)
        name = self.fields[change.constant]
        known = (self.nominal or {}).get(change.joint, {}).get(change.constant, 0.0)
        before = 0.0 if change.constant == "limit" else group.get(name, known)
        group[name] = before + change.value
        if change.low is not None and change.high is not None:
            ranges[name] = (before + change.low, before + change.high)
        return ""

    def _scale(self, change: Change, group: dict[str, float], ranges: dict[str, tuple[float, float]]) -> str:
        """Multiply the gains that the model's servo has; the verdict knows them as shares alone."""
        known = (self.nominal or {}).get(change.joint, {})
        fields = [name for name in GAINS[change.constant] if name in known]
        for name in fields:
            before = group.get(name, known[name])
            group[name] = before * (1.0 + change.value)
            if change.low is not None and change.high is not None:
                ranges[name] = (before * (1.0 + change.low), before * (1.0 + change.high))
        return "" if fields else NO_GAINS

    def text(self, remarks: Sequence[str]) -> str:
        """Return the file."""
        self.finish()
        lines = self.remarks_on(remarks)
        lines += ["RANGES: 95 % intervals of the fields, to draw from in domain randomisation."]
        lines += ["NOISE: standard deviation of readings, the `std` of a GaussianNoiseCfg of observations."]
        used = sorted({self._class(group) for group in self.groups.values()} or {self.plain})
        groups = "".join(f"    {joint!r}: {self._group(joint, group)},\n" for joint, group in self.groups.items())
        ranges = "".join(f"    {joint!r}: {found!r},\n" for joint, found in self.ranges.items() if found)
        noise = "".join(f"    {joint!r}: {found!r},\n" for joint, found in self.noise.items())
        head = "".join(f"# {' '.join(line.splitlines())}\n" for line in lines)
        return (
            f"{head}\nfrom {self.source} import {', '.join(used)}\n\n"
            f"ACTUATORS = {{\n{groups}}}\n\nRANGES = {{\n{ranges}}}\n\nNOISE = {{\n{noise}}}\n{self.beside()}"
        )

    def beside(self) -> str:
        """Return what the file has beside actuators and ranges; default nothing."""
        return ""

    def remarks_on(self, remarks: Sequence[str]) -> list[str]:
        """Return the remarks, whose fields these are and what their values mean."""
        totals = ALONE if self.nominal is None else "Values are totals, with the model's."
        return [*remarks, f"Fields of {self.version}. Delays in steps of {self.step} s. {totals}"]

    def finish(self) -> None:
        """Bring the groups into order before they are written; default nothing."""

    def _class(self, group: Mapping[str, float]) -> str:
        if self.servo and group.keys() & {name for names in GAINS.values() for name in names}:
            return self.servo
        return self.delayed if self.delays[1] in group else self.plain

    def _group(self, joint: str, group: Mapping[str, float]) -> str:
        fields = {**self.always, **group}
        said = "".join(f", {name}={value!r}" for name, value in fields.items())
        return f"{self._class(group)}({self.joints.format(joint)}{said})"
