"""The description of a chain of axes.

Lengths are in m, angles in rad, forces in N and torques in N m; the unit of each recorded signal is stated beside it.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator
from sher3_machines.intake.fields import VELOCITIES, Clock, Column, Strict

from sher3_chain.joint.conditions import Tagged
from sher3_chain.joint.own_unit import DEMANDS, OWN_UNITS, VOLTAGES


class Signals(Strict):
    """Signals of an axis, recorded or computed by the user; `position` must be there.

    `velocity` is no signal that is judged: clock and units are checked against it. `nominal_effort` takes the place of
    mass, weight and coupling of the axis' own model, and comes on top of what the description states; `applied` is a
    disturbance that is known.
    """

    position: Column
    reference: Column | None = None
    command: Column | None = None
    effort: Column | None = None
    load: Column | None = Field(default=None, description="position of a second encoder at the load")
    velocity: Column | None = Field(default=None, description="recorded speed; clock and units are checked against it")
    nominal_effort: Column | None = Field(default=None, description="force that the user's own model asks for")
    temperature: Column | None = Field(default=None, description="of screw, gear or frame, deg C")
    applied: Column | None = Field(default=None, description="known force on the axis, positive along its motion")


class CommandLaw(Strict):
    """How the axis is driven.

    Attributes:
        kind: `force`: command times `gain` is the force; `position`: a servo that takes the reference and whose force
            is not recorded; `none`: nothing drives the axis.
        gain: N, or N m, per unit of the command.
        position_gain, velocity_gain: of command = position_gain * (reference - q) - velocity_gain * v, where known; the
            recorded command is compared with it.
        integral_gain: of the error's integral over time, added to that, per s.
        limit: largest command, where known.
        held: whether a command acts from its stamp to the next one; otherwise it is the force at its stamp.
        goal: constant reference, m or rad, where none was recorded.
        loop: period of the loop that takes the control of a simulated joint, s: its force is that at the begin of a
            row. In a slower log the control may hold from row to row.
    """

    kind: Literal["force", "position", "none"]
    gain: float = 1.0
    position_gain: float | None = None
    velocity_gain: float = 0.0
    integral_gain: float = 0.0
    limit: float | None = Field(default=None, gt=0.0)
    held: bool = False
    goal: float | None = None
    loop: float | None = Field(default=None, gt=0.0)


class Gravity(Strict):
    """Weight on an axis at position q, N or N m: `constant` + `arm` * sin(q - `hanging`).

    Attributes:
        constant: weight that does not depend on the position.
        arm: largest weight of a pendulum.
        hanging: position at which the pendulum hangs down, rad.
    """

    constant: float = 0.0
    arm: float = 0.0
    hanging: float = 0.0


class Axis(Strict):
    """One axis: its nominal constants and what was recorded of it.

    Attributes:
        mass: kg or kg m^2; `unknown`: identified from the data; None: the force balance is not looked at.
        carried: file name of a run, without its ending -> known mass that was put on the axis in it, kg or kg m^2. It
            moves with the axis; its weight, where the axis lifts it, is `applied`.
        viscous: viscous coefficient, N/(m/s) or N m/(rad/s).
        encoder_resolution: one count, m or rad; left out: the `step` of the position's column, in its unit.
        encoder_at: side of the transmission that `position` is read on; with one encoder it says what that one hides.
        effort_resolution: one step of the measured force, N or N m.
        lead: travel per motor revolution, m or rad; without it cogging is not named.
        range: positions the axis can reach, m or rad; what lies far outside is taken for a wrong unit, and at its ends
            are stops: by a count or beyond them nothing is judged; None: stops are looked for (`axes/stops.py`).
    """

    name: str = Field(min_length=1)
    motion: Literal["linear", "rotary"]
    signals: Signals
    command_law: CommandLaw
    mass: Annotated[float, Field(gt=0.0)] | Literal["unknown"] | None = None
    carried: Mapping[str, Annotated[float, Field(gt=0.0)]] = Field(default_factory=dict)
    viscous: float = Field(default=0.0, ge=0.0)
    gravity: Gravity = Gravity()
    encoder_resolution: float = Field(gt=0.0)
    encoder_at: Literal["motor", "load"] = "motor"
    effort_resolution: float = Field(default=0.0, ge=0.0)
    lead: float | None = Field(default=None, gt=0.0)
    range: tuple[float, float] | None = None

    @model_validator(mode="before")
    @classmethod
    def _counted(cls, data: Any) -> Any:
        """Take the count of the encoder from the step of the position's column, where it is not stated itself."""
        match data:
            case {"encoder_resolution": _}:
                return data
            case {"signals": {"position": {"step": float() | int() as step} as column}}:
                return {**data, "encoder_resolution": abs(step * Column.model_validate(column).scale)}
        return data

    @model_validator(mode="after")
    def _complete(self) -> Axis:
        law, signals = self.command_law, self.signals
        if law.kind == "position" and signals.reference is None:
            raise ValueError(f"axis {self.name}: a position servo needs its recorded reference")
        if law.kind == "force" and not self.driven and self.needs_force:
            raise ValueError(f"axis {self.name}: a force-driven axis needs its recorded command or effort")
        if self.carried and not isinstance(self.mass, float):
            raise ValueError(f"axis {self.name}: what it carried is told beside a stated `mass` alone")
        return self

    @property
    def driven(self) -> bool:
        """Whether a command or an effort was recorded."""
        return self.signals.command is not None or self.signals.effort is not None

    @property
    def needs_force(self) -> bool:
        """Whether a force-driven axis without a recorded force is refused: by itself nothing of it can be judged."""
        return True

    @property
    def servo(self) -> bool:
        """Whether the axis is a position servo: forces are then told in units of its stiffness."""
        return self.command_law.kind == "position"

    @property
    def summed(self) -> bool:
        """Whether a speed was recorded or asked in place of a place, which is then its sum."""
        asked = (self.signals.position, self.signals.reference)
        return any(column is not None and column.unit in VELOCITIES for column in asked)

    @property
    def tracked(self) -> Axis | None:
        """The axis as a position servo, whose force nobody knows; None where it is one, or has no reference.

        Neither where the gains of its loop are stated: such a loop follows late by itself, which is no gap.
        """
        stated = self.command_law.position_gain is not None
        if self.servo or self.free or stated or self.signals.reference is None:
            return None
        return self.model_copy(update={"command_law": CommandLaw(kind="position"), "mass": None})

    @property
    def swings(self) -> bool:
        """Whether the axis turns and nothing is said of a weight at an arm."""
        return self.motion == "rotary" and self.gravity.arm == 0.0 and self.signals.nominal_effort is None

    @property
    def free(self) -> bool:
        """Whether nothing drives the axis."""
        return self.command_law.kind == "none"

    @property
    def replayable(self) -> bool:
        """Whether the axis can be run again in its control loop: the loop's gains and its reference are known.

        The simulated loop has no integral, whose start nobody knows.
        """
        law = self.command_law
        known = law.position_gain is not None and not law.integral_gain
        return law.kind == "force" and known and self.signals.reference is not None

    @property
    def unit_of_position(self) -> str:
        """Unit of positions."""
        return "m" if self.motion == "linear" else "rad"

    @property
    def own_unit(self) -> str:
        """Unit of forces that nobody made newtons; empty where they are, or a mass says that they are."""
        source, gain = self.signals.effort, 1.0
        if source is None:
            source, gain = self.signals.command, self.command_law.gain
        if self.servo or self.free or isinstance(self.mass, float) or source is None:
            return ""
        stated = source.factor != 1.0 or gain != 1.0 or self.signals.nominal_effort is not None
        return "" if stated else OWN_UNITS.get(source.unit or "", "")

    @property
    def effort_is_demand(self) -> bool:
        """Whether what was recorded of the drive is no force yet."""
        read, command = self.signals.effort, self.signals.command
        return read.unit in VOLTAGES if read is not None else command is not None and command.unit in DEMANDS

    @property
    def effort_as_read(self) -> tuple[float, str]:
        """Force per unit of the recorded effort, and the unit of that force."""
        return 1.0, self.unit_of_force

    @property
    def unit_of_force(self) -> str:
        """Unit of forces."""
        if self.own_unit:
            return self.own_unit
        return "N" if self.motion == "linear" else "N*m"


class ChainDescription(Tagged):
    """A chain of joints that were recorded together.

    Attributes:
        time: of the samples.
        repeats: whether the data files are repeats of one motion.
    """

    time: Clock
    repeats: bool = False

    @property
    @abstractmethod
    def chain(self) -> Sequence[Axis]:
        """Every joint, in the order of the chain."""


class AxesDescription(ChainDescription):
    """A chain of axes, each moved by its own drive.

    Attributes:
        axes: in the order of the chain.
    """

    kind: Literal["axes"]
    axes: tuple[Axis, ...] = Field(min_length=1)

    @property
    def chain(self) -> Sequence[Axis]:
        """The axes."""
        return self.axes

    @model_validator(mode="after")
    def _distinct(self) -> AxesDescription:
        names = [a.name for a in self.axes]
        if len(set(names)) < len(names):
            raise ValueError(f"axis names repeat: {', '.join(names)}")
        return self
