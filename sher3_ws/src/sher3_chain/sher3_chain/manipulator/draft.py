"""A drafted chain of axes as the arm of a URDF or MJCF file: which axis is which joint, and what its effort is in."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

from sher3_machines.drafting.draft import drafted, written
from sher3_machines.drafting.guesses import period_of_log
from sher3_machines.drafting.names import EFFORT, words_of
from sher3_machines.drafting.unnamed import as_recorded, named_by_blocks, renamed
from sher3_machines.errors import MachineError
from sher3_machines.intake.kind import Draft
from sher3_machines.intake.runs import longest
from sher3_machines.intake.tables import Tables

from sher3_chain.manipulator.bodies import Bodies, read_bodies
from sher3_chain.manipulator.mjcf.drives import Driven
from sher3_chain.manipulator.mjcf.joint import OWN_EFFORT, drive_joint

TORQUES = EFFORT - frozenset(("iq", "strom", "amps"))
"""Words of an effort that is a force or a torque where its name has no unit."""
OPEN = frozenset(("effort", "efforts"))
"""Words of them that a JointState has for a torque, where drivers of Universal Robots write a current."""
CALLED = "it is called a force or a torque"
DEFINED = "a JointState says so; where the driver writes currents, as Universal Robots' do, state `gain: unknown`"
"""Why an effort without a unit is in N or N m."""
FORCES = ("N", "kN", "N*m", "mN*m")
OF_JOINT = ("position", "velocity", "reference", "effort", "command", "load")
"""Signals of a joint that a draft keeps: an arm is judged by its forces."""
GAINS = "state the servo's `command_law: {kind: force, position_gain: N m/rad, velocity_gain: N m s/rad}`"
"""How a joint is judged whose force was not recorded."""
OF_AXIS = re.compile(r": (driven by|mass is not|a position servo|undriven)")
"""Guesses on single axes that an arm has no use for."""


def draft_arm(path: Path, model: Path, rate: float | None = None, tables: Tables | None = None) -> Draft:
    """Draft the description of an arm in motion from a data file, folder or bag.

    Args:
        path: of the data.
        model: URDF or MJCF of the arm.
        rate: samples per second, Hz, where no time was recorded.
        tables: what the path holds, where it has been read.

    Raises:
        MachineError: data or model cannot be read, no column looks like a time or a position, or the columns do not fit
            the joints.
    """
    guesses: list[str] = []
    bodies, tables = read_bodies(model), longest(path) if tables is None else tables
    names = named_by_blocks(tables, rate, len(bodies.joints), guesses)
    tables = renamed(names, tables) if names else tables
    chain = drafted(path, tables, rate, guesses, held=True)
    return written(
        as_recorded(arm_description(chain, bodies, guesses, period=period_of_log(chain["time"], tables)), names),
        guesses,
    )


def arm_description(
    data: Mapping[str, Any],
    model: Bodies,
    guesses: list[str],
    drives: Mapping[str, Driven] | None = None,
    simulated: bool | None = None,
    period: float = 0.0,
) -> dict[str, Any]:
    """Return a drafted chain of axes as the joints of a model; raises MachineError where they do not fit.

    Where commands were recorded and the force of no joint is known, the chain remains one of servos, named as joints.

    Args:
        data: of the chain.
        model: of the arm.
        guesses: so far; those on driving and mass of single axes are taken out.
        drives: in place of the model's.
        simulated: whether efforts are a simulator's own; default by the names of their columns.
        period: of the log, s; 0: not known.
    """
    slides, drives = model.joints, model.drives if drives is None else drives
    axes = {axis["name"]: axis for axis in data["axes"]}
    found = fitted(list(axes), list(slides), model.label)
    guesses[:] = [g for g in guesses if not OF_AXIS.search(g)]
    guesses += [
        f"{axis} is joint {joint}, because of its {why}" for axis, (joint, why) in found.items() if axis != joint
    ]
    recorded = [joint for joint, _ in found.values()]
    led = model.follow(recorded, guesses)
    joints = [_joint(axes[a], joint, slides[joint], guesses) for a, (joint, _) in found.items() if joint not in led]
    for joint in joints:
        if joint["name"] in drives:
            effort = joint["signals"].get("effort", {})
            words = set(words_of(effort.get("column", "")))
            own = drives[joint["name"]]
            if "actuator" in words and "qfrc" not in words and own.drive is not None and own.drive.gear != 1.0:
                effort["factor"] = own.drive.gear
            drive_joint(joint, own, bool(words & OWN_EFFORT) if simulated is None else simulated, guesses, period)
    if unforced := [j for j in joints if "reference" in j["signals"] and not _has_force(j)]:
        names = [j["name"] for j in unforced]
        why = dict.fromkeys(f"; {drives[name].reason}" for name in names if name in drives)
        guesses.append(f"a reference and no force was recorded{''.join(why)}: {GAINS} of {', '.join(names)}")
        if not any(map(_has_force, joints)):
            guesses.append("without it the model is not used: each joint is a servo by itself, `kind: axes`")
            of_joint = {joint: axes[a] for a, (joint, _) in found.items()}
            return {**data, "axes": [{**of_joint[j["name"]], **j} for j in unforced]}
    model.at_rest(recorded, guesses)
    out = {"kind": "manipulator", "name": data["name"], "model": str(Path(model.label).resolve()), "time": data["time"]}
    return {**out, "joints": joints}


def fitted(axes: Sequence[str], joints: Sequence[str], model: object) -> dict[str, tuple[str, str]]:
    """Return axis -> joint and why: by name, by number, or in their order where there are as many.

    Raises:
        MachineError: none of these does.
    """
    plain = {_plain(joint): joint for joint in joints}
    if all(_plain(axis) in plain for axis in axes):
        return {axis: (plain[_plain(axis)], "name") for axis in axes}
    own = {axis: n for axis in axes if (n := _number(axis)) is not None}
    if len(set(own.values())) == len(axes):
        chain = _chain_of(own.values(), joints)
        if chain is not None:
            return {axis: (chain[n], "number") for axis, n in own.items()}
    if len(axes) == len(joints):
        return {axis: (joint, "order") for axis, joint in zip(axes, joints, strict=True)}
    raise MachineError(
        f"{model}: columns and joints do not fit",
        value=f"{len(axes)} columns: {', '.join(axes[:8])}",
        limit=f"{len(joints)} joints: {', '.join(joints[:8])}",
        remedy="name columns as the joints are, or write `joints` by hand",
    )


def _chain_of(own: Collection[int], joints: Sequence[str]) -> dict[int, str] | None:
    """Return number -> joint of columns that are numbered, None where none or several chains of joints fit.

    Joints whose names differ in one number are a chain; fingers have numbers of their own. Numbers may begin elsewhere
    than those of the columns. Where no chain of numbers is most of the machine, joints count in their order.
    """
    chains: dict[str, dict[int, str]] = {}
    for joint in joints:
        for found in re.finditer(r"\d+", joint):
            chains.setdefault(f"{joint[: found.start()]}#{joint[found.end() :]}", {})[int(found[0])] = joint
    longest = max(chains.values(), key=len, default={})
    alike = [chain for chain in chains.values() if len(chain) == len(longest)]
    numbered = longest if 2 * len(longest) > len(joints) else dict(enumerate(joints))
    starts = (0, min(numbered) - min(own)) if len(alike) < 2 or numbered is longest else ()
    return next(({n: numbered[n + by] for n in own} for by in starts if {n + by for n in own} <= set(numbered)), None)


def _number(name: str) -> int | None:
    """Return the number that a name ends in."""
    found = re.search(r"\d+$", name)
    return int(found[0]) if found else None


def _has_force(joint: Mapping[str, Any]) -> bool:
    """Return whether the force of a joint was recorded, or follows from the law of its drive."""
    return "command_law" in joint or not {"effort", "command"}.isdisjoint(joint["signals"])


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _joint(axis: Mapping[str, Any], joint: str, slides: bool, guesses: list[str]) -> dict[str, Any]:
    """Return one joint of a draft: its effort in N m where it is called a torque, else with a gain to be found."""
    signals = {name: dict(axis["signals"][name]) for name in OF_JOINT if name in axis["signals"]}
    if slides and signals["position"]["unit"] == "rad":
        signals["position"]["unit"] = "m"
    out = {"name": joint, "motion": "linear" if slides else "rotary", "signals": signals}
    if slides and "velocity" in signals and signals["velocity"]["unit"] == "rad/s":
        signals["velocity"]["unit"] = "m/s"
    if "reference" in signals:
        signals["reference"]["unit"] = signals["position"]["unit"]
    effort = signals.get("effort") or signals.get("command")
    if effort is not None and effort["unit"] not in FORCES:
        said = set(words_of(effort["column"])) & TORQUES
        if "effort" in signals and effort["unit"] == "1" and said:
            effort["unit"] = "N" if slides else "N*m"
            guesses.append(f"{joint}: effort in {effort['unit']}, because {CALLED if said - OPEN else DEFINED}")
        else:
            out["gain"] = "unknown"
            guesses.append(
                f"{joint}: gain unknown: {effort['column']!r} is no torque; state N m per unit where you can"
            )
    return out
