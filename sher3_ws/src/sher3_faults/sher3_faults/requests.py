"""A fault as it is asked for on `mock/fault`: one line of JSON, validated at the door.

{"component": "force_sensor", "fault": "delayed", "duration": 0.5, "parameters": {"delay": 0.03}}
"""

from __future__ import annotations

from difflib import get_close_matches
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sher3_description import ACTUATORS

from sher3_faults.errors import FaultRefused
from sher3_faults.kinds import KINDS, OFF, OK, bounds_of

Seconds = Annotated[float, Field(ge=0.0, le=3600.0, allow_inf_nan=False)]

LINES = ("bus", *(f"bus{i}" for i in range(5)), *ACTUATORS)
"""Where frames run: all channels, one of them, or one drive's share of its channel."""
PARTS = ("load_encoder", "motor_encoder", "encoders", "demand", "power", "motor", "echo")
"""What each axis has: its two encoders, both alike (`encoders`), the velocity demand in its drive, what the power stage
does while it has power, what the motor does with power or without (`motor`), and what the drive says of its demand."""
STATUSWORD, RESETS = "statusword", "resets"
MISWIRED = "miswired"
WIRES = "wires"
PLUGS = {
    WIRES: ("command", "demand", "effort", "motor_position", "load_position"),
    f"{WIRES}.motors": ("command", "demand", "effort"),
    f"{WIRES}.encoder_pairs": ("motor_position", "load_position"),
    f"{WIRES}.motor_encoders": ("motor_position",),
    f"{WIRES}.load_encoders": ("load_position",),
}
"""Plugs between drives and axes, with the columns that go through them; `wires`: those of motors and encoders."""
GROUPS = {"legs": ACTUATORS[:3], "axes": ACTUATORS}
"""Several axes that have the same fault at the same time."""
DEVICES = (
    "force_sensor",
    "pedal",
    "pedal.travel",
    "pedal.contact",
    "safe_torque_off",
    *(name + way for name in LINES for way in ("", ".up", ".down")),
    *(f"{name}.{part}" for name in (*ACTUATORS, *GROUPS) for part in PARTS),
    *(f"{name}.{part}" for name in ACTUATORS for part in (STATUSWORD, RESETS)),
    *PLUGS,
)
"""What the plant process can break: `.up` is towards the host, `.down` towards the drives; without either, both.
`safe_torque_off` is the line that takes the torque from all motors: `off`. A `statusword` is wrong by the bits of
`code`. `resets` are the frames that ask a drive to leave FAULT: `off`."""
PROCESSES = ("force_sensor", "pedal", "admittance", "kinematics", "motor_driver", "supervisor", "plant", "recorder")
OTHERS = ("all", "clock", *(f"clock.{name}" for name in PROCESSES), *(f"process.{name}" for name in PROCESSES))
"""`all` goes with `ok`; clock and processes are broken from outside, by `sher3 safety`: the plant only notes them."""


class FaultRequest(BaseModel):
    """One fault to inject.

    Attributes:
        component: one of `DEVICES` or `OTHERS`.
        fault: one of `kinds.KINDS`, or `ok` to end it.
        start: seconds from now until it begins.
        duration: seconds it lasts; None until `ok`.
        seed: of everything random in it.
        parameters: of the kind.
        label: free text for whoever reads the recording.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    component: Annotated[str, Field(max_length=60)]
    fault: Annotated[str, Field(max_length=20)]
    start: Seconds = 0.0
    duration: Seconds | None = None
    seed: Annotated[int, Field(ge=0, lt=2**63)] = 0
    parameters: dict[str, Annotated[float, Field(allow_inf_nan=False)]] = {}
    label: Annotated[str, Field(max_length=200)] = ""

    def to_json(self) -> str:
        """Return the line for `mock/fault`."""
        return self.model_dump_json(exclude_defaults=True)


def parse_request(text: str) -> FaultRequest:
    """Return the request of a line.

    Raises:
        FaultRefused: it is no JSON object of that form, or names what does not exist.
    """
    try:
        request = FaultRequest.model_validate_json(text)
    except ValidationError as error:
        raise _refused("?", "?", error) from None
    return checked(request)


def make_request(**values: Any) -> FaultRequest:
    """Return a validated request; see `parse_request`."""
    try:
        request = FaultRequest.model_validate(values)
    except ValidationError as error:
        raise _refused(str(values.get("component")), str(values.get("fault")), error) from None
    return checked(request)


def _nearest(name: str, known: tuple[str, ...], otherwise: str) -> str:
    near = get_close_matches(name, known, 1)
    return f"did you mean {near[0]}?" if near else otherwise


def checked(request: FaultRequest) -> FaultRequest:
    """Return the request.

    Raises:
        FaultRefused: unknown component, kind or parameter, or a parameter out of range.
    """
    component, fault = request.component, request.fault
    if component not in DEVICES and component not in OTHERS:
        known = (*DEVICES, *OTHERS)
        whole = ", ".join(name for name in known if "." not in name)
        remedy = _nearest(component, known, "parts follow a dot, as in roll.demand")
        raise FaultRefused(component, fault, "no such component", value=component, limit=whole, remedy=remedy)
    if fault not in KINDS and fault != OK:
        known, remedy = (*KINDS, OK), _nearest(fault, (*KINDS, OK), "choose one of them")
        raise FaultRefused(component, fault, "no such fault", value=fault, limit=", ".join(known), remedy=remedy)
    part = component.partition(".")[2]
    if (component == "safe_torque_off" or part == RESETS) and fault not in (OFF, OK):
        raise FaultRefused(component, fault, "it comes or it does not", value=fault, limit=f"{OFF}, {OK}")
    if part == STATUSWORD and fault not in ("wrong", OK):
        raise FaultRefused(component, fault, "a drive tells its own state", value=fault, limit=f"wrong, {OK}")
    if (component in PLUGS) != (fault == MISWIRED) and fault != OK:
        raise FaultRefused(component, fault, "only plugs are miswired", value=fault, limit=", ".join(PLUGS))
    if component == "all" and fault != OK:
        raise FaultRefused(component, fault, "only ok goes with all", remedy="name one component")
    bounds = bounds_of(fault) if component in DEVICES else {}
    for name, value in request.parameters.items():
        if component not in DEVICES:
            continue
        if name not in bounds:
            raise FaultRefused(component, fault, "no such parameter", value=name, limit=", ".join(bounds) or "none")
        if not bounds[name].low <= value <= bounds[name].high:
            limit = f"{bounds[name].low:g} to {bounds[name].high:g}"
            raise FaultRefused(component, fault, f"{name} is out of range", value=value, limit=limit)
    return request


def _refused(component: str, fault: str, error: ValidationError) -> FaultRefused:
    first = error.errors()[0]
    where = ".".join(map(str, first["loc"])) or "request"
    return FaultRefused(component, fault, f"{where}: {first['msg']}", remedy="see `sher3 fault --help`")
