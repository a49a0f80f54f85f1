"""A joint as its model drives it: what its control is, and the force that the control stands for."""

from __future__ import annotations

from typing import Any

from sher3_chain.manipulator.mjcf.drives import Drive, Driven, Step, steps_in

OWN_EFFORT = frozenset(("actuator", "qfrc"))
"""Words in a column's name by which an effort is MuJoCo's own: `actuator_force`, `qfrc_actuator`."""


def drive_joint(joint: dict[str, Any], own: Driven, simulated: bool, guesses: list[str], period: float = 0.0) -> None:
    """Write what a model says of the drive of a joint into the joint's part of a description.

    The control of a servo is its reference, that of a motor its force. Without a recorded effort the law of the drive
    gives it.

    Args:
        joint: of a description, as plain data; a control that was recorded is its signal `command`.
        own: of the joint in the model.
        simulated: whether a recorded effort is the simulator's own.
        guesses: so far; what is taken from the model is added.
        period: of the log, s.
    """
    name, signals, drive = joint["name"], joint["signals"], own.drive
    measured = "effort" in signals
    step = own.recorded if simulated and measured else Step()
    if drive is None:
        if signals.pop("command", None) is not None:
            known = "" if measured else "; record efforts, this joint is not judged"
            guesses.append(f"{name}: its control is not used, because {own.reason}{known}")
    elif drive.servo:
        within = step.damping or (simulated and measured and steps_in(period, own.loop) > 1.0)
        if within and {"command", "reference"} & signals.keys():
            signals.pop("effort")
            guesses.append(f"{name}: the effort is that of its law, which the simulator follows within a row")
        _servo(joint, drive, guesses)
        if "reference" in signals and "effort" not in signals:
            step = own.of_law
    else:
        _motor(joint, drive, guesses)
        step = own.recorded if simulated or not measured else step
    if own.loop and (simulated or "effort" not in signals):
        law = _gains(drive) if drive is not None and drive.servo else {}
        joint["command_law"] = {"kind": "force", **law, **joint.get("command_law", {}), "loop": own.loop}
    _stepped(joint, own, step, guesses)


def _stepped(joint: dict[str, Any], own: Driven, step: Step, guesses: list[str]) -> None:
    """Write what a step of a simulator adds to an effort."""
    name, signals = joint["name"], joint["signals"]
    if step.inertia:
        joint["step_inertia"] = float(f"{step.inertia:.6g}")
        text = f"{step.inertia:.4g} {'kg' if own.slides else 'kg*m^2'}"
        guesses.append(f"{name}: a step of the simulator adds {text} to what this effort moves")
    if step.damping:
        joint["viscous"] = float(f"{own.damping + step.damping:.6g}")
        guesses.append(f"{name}: a step of the simulator adds {step.damping:.4g} per speed to this effort")
    forces = [signals[x] for x in ("effort", "reference", "command") if x in signals][:1] if step.late else []
    for signal in forces:
        signal["late"] = signal.get("late", 0.0) + step.late
        guesses.append(f"{name}: its force acts {1e3 * step.late:.4g} ms late: the simulator holds it over a step")


def _servo(joint: dict[str, Any], drive: Drive, guesses: list[str]) -> None:
    signals, place = joint["signals"], "m" if joint["motion"] == "linear" else "rad"
    control = signals.pop("command", None)
    if control is not None and "reference" not in signals:
        signals["reference"] = {**control, "unit": place}
        if drive.factor != 1.0:
            signals["reference"]["factor"] = drive.factor
    if "reference" not in signals:
        return
    _delayed(signals["reference"], joint, drive, guesses)
    joint["command_law"] = {"kind": "force", **_gains(drive), **({"limit": drive.limit} if drive.limit else {})}
    if "effort" not in signals:
        _force_known(joint, guesses)
    text = f"{joint['name']}: its control is the reference of servo {drive.name}"
    force = f"{drive.position_gain:.4g} (reference - q) - {drive.velocity_gain:.4g} v"
    guesses.append(text if "effort" in signals else f"{text}, whose force is {force}: no effort was recorded")


def _gains(drive: Drive) -> dict[str, float]:
    return {"position_gain": drive.position_gain, "velocity_gain": drive.velocity_gain}


def _motor(joint: dict[str, Any], drive: Drive, guesses: list[str]) -> None:
    signals = joint["signals"]
    if "command" not in signals:
        return
    unit = "N" if joint["motion"] == "linear" else "N*m"
    signals["command"] = {**signals["command"], "unit": unit}
    _delayed(signals["command"], joint, drive, guesses)
    joint["command_law"] = {"kind": "force", "gain": drive.factor}
    if "effort" not in signals:
        _force_known(joint, guesses)
    guesses.append(f"{joint['name']}: its control times {drive.factor:.4g} is the force of motor {drive.name}, {unit}")


def _delayed(signal: dict[str, Any], joint: dict[str, Any], drive: Drive, guesses: list[str]) -> None:
    """Let a control act as late as the model says, and within the range that it states."""
    if drive.within is not None:
        signal["within"] = list(drive.within)
    if drive.delay:
        signal["late"] = drive.delay
        guesses.append(f"{joint['name']}: its control acts {1e3 * drive.delay:.4g} ms late, as the model says")


def _force_known(joint: dict[str, Any], guesses: list[str]) -> None:
    """Take back that the gain of a joint is not known."""
    joint.pop("gain", None)
    guesses[:] = [guess for guess in guesses if not guess.startswith(f"{joint['name']}: gain unknown")]
