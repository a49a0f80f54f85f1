"""Checks on a case before it is diagnosed: slips that would look like a cause are named, missing data are said.

`audit` raises for data no answer could rest on and returns notes for data that narrow it. Ranges are the robot's own: a
reading far outside what the machine can do is a slip, and the factor by which it is outside names the slip.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np
from sher3_bags import Case
from sher3_common import Sher3Error
from sher3_description import ACTUATORS, Robot
from sher3_diagnosis.channel import Array
from sher3_diagnosis.filter import EDGE

from sher3_gap.errors import CaseError
from sher3_gap.signals import RunSignals

BEYOND = 2.0
"""Times its range at which a reading can no longer be meant in SI units."""
SLIPS = {"mm for m": 1e3, "um for m": 1e6, "deg for rad": 180.0 / np.pi, "mN for N": 1e3, "N*mm for N*m": 1e3}
FEW_RUNS = 5
STAGES_OF = {
    "command": ("servo_jv", "transport and controller"),
    "echo": ("drives/setpoint_jv", "transport, drive and motor mechanics"),
    "effort": ("drives/measured_js effort", "drive and motor mechanics"),
    "load": ("measured_js", "controller and transmission"),
    "reference": ("setpoint_js", "controller and the end-to-end tip"),
    "tracker_position": ("tracker/measured_cp", "mechanism and structure"),
    "wrench": ("force/measured_cf", "sensing"),
}
"""Signal -> topic and the stages that cannot be judged without it."""


def check_parameters(case: Case) -> None:
    """Refuse runs that were recorded with other parameters than the case states.

    Raises:
        CaseError: the robot.yaml attached to a run is not that of the case, states another tolerance, or cannot be
            read.
    """
    wanted = case.robot.digest()
    for index, run in enumerate(case.runs):
        if not run.robot_yaml:
            continue
        name = run.path.name if run.path else f"run {index}"
        try:
            found = Robot.from_yaml(run.robot_yaml)
        except Sher3Error as error:
            raise CaseError(
                f"{name}: its attached robot.yaml is wrong: {error.what}",
                value=error.value,
                remedy="record again with a robot.yaml that `sher3 up` takes",
            ) from error
        if found.digest() != wanted:
            raise CaseError(
                f"{name}: recorded with other parameters than the case's robot.yaml",
                value=_difference(found, case.robot),
                remedy="put runs of different parameters into different cases",
            )
        _check_tolerances(name, found, case.robot)


def _check_tolerances(name: str, run: Robot, case: Robot) -> None:
    """Refuse a run whose file states another tolerance than the case's; a file that states none agrees with any."""
    if "tolerances" not in run.model_fields_set or "tolerances" not in case.model_fields_set:
        return
    for quantity in run.tolerances.model_fields_set & case.tolerances.model_fields_set:
        here, there = getattr(run.tolerances, quantity), getattr(case.tolerances, quantity)
        if here != there:
            raise CaseError(
                f"{name}: its robot.yaml and the case's state two tolerances.{quantity}",
                value=here,
                limit=there,
                remedy="keep the one that was measured",
            )


def _difference(found: Robot, wanted: Robot) -> str:
    """Return the first parameter that differs, as `path: value instead of value`."""
    a, b = _flat(found.model_dump()), _flat(wanted.model_dump())
    path = next((k for k in a if a[k] != b.get(k)), "")
    return f"{path} {a.get(path)} instead of {b.get(path)}"


def _flat(value: object, path: str = "") -> dict[str, object]:
    if isinstance(value, dict):
        return {k: v for key, x in value.items() for k, v in _flat(x, f"{path}.{key}".lstrip(".")).items()}
    if isinstance(value, list | tuple):
        return {k: v for i, x in enumerate(value) for k, v in _flat(x, f"{path}[{i}]").items()}
    return {path: value}


def audit(runs: Sequence[RunSignals], robot: Robot) -> list[str]:
    """Check runs and return what narrows the answer, one sentence each.

    Raises:
        CaseError: a unit slip, or repeats that were not the same command.
    """
    for run in runs:
        _check_units(run, robot)
    _check_repeats(runs, robot)
    return [*_few_repeats(runs), *_missing(runs), *_holes(runs)]


def _holes(runs: Sequence[RunSignals]) -> list[str]:
    """Say how many ticks of a live recording do not count."""
    ticks = sum(run.ticks for run in runs)
    lost = sum(int(run.lost.sum()) for run in runs if run.lost is not None)
    held = sum(int(run.held.sum()) for run in runs if run.held is not None)
    stale = sum(int(run.stale.sum()) for run in runs if run.stale is not None)
    notes = []
    if lost:
        notes.append(
            f"{lost} of {ticks} ticks were not recorded: bridged, and nothing is judged {EDGE:g} s around them"
        )
    if held or stale:
        notes.append(
            f"the computer was late: at {held} of {ticks} ticks the drives held the demand before, at {stale} the host "
            "used an earlier reading; these are not held against the robot"
        )
    return notes


def _check_units(run: RunSignals, robot: Robot) -> None:
    actuators = robot.actuators
    travel = np.array([max(abs(a.limits.lower), a.limits.upper) for a in actuators])
    speed = np.array([a.limits.velocity for a in actuators])
    for topic, values in (("drives/measured_js", run.motor), ("measured_js", run.load), ("setpoint_js", run.reference)):
        _check_axes(run.name, f"{topic} position", values, travel, "mm for m")
    for topic, values in (("servo_jv", run.command), ("drives/setpoint_jv", run.echo)):
        _check_axes(run.name, f"{topic} velocity", values, speed, "mm for m")
    _check_axes(run.name, "setpoint_js velocity", run.reference_velocity, speed, "mm for m")
    effort = np.array([a.drive.limit for a in actuators])
    _check_axes(run.name, "drives/measured_js effort", run.effort, effort, "mN for N")
    if run.wrench is not None:
        sensor = robot.force_sensor
        _check(run.name, "force/measured_cf force", run.wrench[:, :3], np.array(sensor.range_force), "mN for N")
        _check(run.name, "force/measured_cf torque", run.wrench[:, 3:], np.array(sensor.range_torque), "N*mm for N*m")
    if run.tracker_position is not None:
        reach = robot.delta.link_length + robot.arm.d1 + robot.arm.d2 + robot.arm.d3 + np.linalg.norm(robot.arm.tool)
        _check(run.name, "tracker/measured_cp position", run.tracker_position, np.full(3, reach), "mm for m")
    if run.temperature is not None and not -40.0 < float(np.median(run.temperature)) < 120.0:
        value = f"{np.median(run.temperature):.1f}"
        slip = "K for deg C" if 230.0 < np.median(run.temperature) < 400.0 else "not deg C"
        raise CaseError(f"{run.name}: temperature looks like {slip}", value=value, remedy="record degrees Celsius")


def _check_axes(name: str, what: str, values: Array | None, top: Array, slip: str) -> None:
    """Check an (n, 5) signal; the roll axis slips by degrees."""
    if values is None:
        return
    for i, actuator in enumerate(ACTUATORS):
        kind = "deg for rad" if actuator == "roll" and slip == "mm for m" else slip
        _check(name, f"{what} of {actuator}", values[:, [i]], top[[i]], kind)


def _check(name: str, what: str, values: Array, top: Array, slip: str) -> None:
    """Refuse values beyond their range, naming the slip when its factor brings them back into it."""
    if len(values) == 0:
        return
    typical = np.percentile(np.abs(values), 95, axis=0) / top
    worst = int(np.argmax(typical))
    if typical[worst] <= BEYOND:
        return
    named = next((s for s, f in _guesses(slip) if typical[worst] / f <= BEYOND), "another unit")
    raise CaseError(
        f"{name}: {what} looks like {named}",
        value=float(typical[worst] * top[worst]),
        limit=float(top[worst]),
        remedy="record SI units (REP-103)",
    )


def _guesses(slip: str) -> list[tuple[str, float]]:
    return [(slip, SLIPS[slip]), *((("um for m", SLIPS["um for m"]),) if slip == "mm for m" else ())]


def _check_repeats(runs: Sequence[RunSignals], robot: Robot) -> None:
    """Refuse repeats whose set-points differ: their spread would pass for the floor."""
    counts = np.array([a.motor_encoder for a in robot.actuators])
    first: dict[str, RunSignals] = {}
    for run in runs:
        if run.reference is None:
            continue
        other = first.setdefault(run.excitation, run)
        assert other.reference is not None
        n = min(run.ticks, other.ticks)
        apart = np.abs(run.reference[:n] - other.reference[:n]).max(axis=0) / counts
        worst = int(np.argmax(apart))
        if apart[worst] > 20.0:
            raise CaseError(
                f"{run.name} and {other.name} are repeats of {run.excitation!r} with other set-points",
                value=f"{apart[worst]:.0f} encoder counts on {ACTUATORS[worst]}",
                limit="20",
                remedy="give other commands another excitation name",
            )


def _few_repeats(runs: Sequence[RunSignals]) -> list[str]:
    groups: dict[str, int] = defaultdict(int)
    for run in runs:
        groups[run.excitation] += 1
    notes = []
    if max(groups.values()) < 2:
        notes.append(
            "no excitation was repeated: the floor is what the readings resolve, not what the robot repeats; "
            "a gap near the floor may be scatter"
        )
    if len(runs) < FEW_RUNS:
        notes.append(f"{len(runs)} runs carry no intervals: closure and parameters are given as values alone")
    if len(runs) < 2:
        notes.append("a single run leaves nothing to hold out: no cause can be checked on data it was not fitted to")
    return notes


def _missing(runs: Sequence[RunSignals]) -> list[str]:
    notes = []
    guided = sum(run.reference is None and not run.loaded_ok.any() for run in runs)
    if guided:
        notes.append(
            f"{guided} of {len(runs)} runs have no set-points: somebody guided the tool by a force that is not known: "
            "only transport, drive and transmission are judged in them"
        )
    for signal, (topic, stages) in STAGES_OF.items():
        without = sum(getattr(run, signal) is None for run in runs)
        if without == len(runs):
            notes.append(f"{topic} was not recorded: {stages} cannot be judged")
        elif without:
            notes.append(f"{topic} is missing in {without} of {len(runs)} runs: they do not count for {stages}")
    return notes
