"""The description of a serial arm in motion; lengths are in m, angles in rad, forces in N, torques in N m."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Literal

from pydantic import Field, model_validator
from sher3_machines.intake.fields import Strict

from sher3_chain.joint.description import Axis, ChainDescription, CommandLaw
from sher3_chain.joint.own_unit import RECORDED

Row = tuple[float, ...]
PER_RUN = "per_run"
"""Gain of a joint whose effort is in another unit in every run."""


class Joint(Axis):
    """One joint that was recorded; its name is that of the model.

    Attributes:
        gain: N, or N m, per unit of the recorded effort or command; `unknown`: the effort is recorded in units of its
            own, such as a motor current, and the model's inertias tell how many of them a newton metre is; `per_run`:
            they tell it run by run, and the efforts are brought to newton metres.
        viscous: damping of the nominal model; where it is not stated, that of an MJCF file.
        step_inertia: kg or kg m^2 by which a simulator's own effort is larger than the one that acted: an implicit step
            takes damping and velocity gain at its end, so it is about the time step times them.
    """

    command_law: CommandLaw = CommandLaw(kind="force")
    gain: float | Literal["unknown", "per_run"] = 1.0
    step_inertia: float = 0.0

    @property
    def driven(self) -> bool:
        """Whether its force is known: recorded, or that of a servo whose gains and reference are."""
        return super().driven or self.follows

    @property
    def follows(self) -> bool:
        """Whether its servo's gains and reference are known."""
        return self.command_law.position_gain is not None and self.signals.reference is not None

    @property
    def by_its_law(self) -> bool:
        """Whether the law of its servo stands for its effort, since none was recorded."""
        return self.follows and self.signals.effort is None and self.signals.command is None

    @property
    def needs_force(self) -> bool:
        """Whether a joint without a recorded force is refused: no, it only moves the others."""
        return False

    @property
    def effort_as_read(self) -> tuple[float, str]:
        """Force per unit of the recorded effort, and its unit: that of the recorder where no gain is stated."""
        newton = "N" if self.motion == "linear" else "N*m"
        return (1.0, RECORDED) if isinstance(self.gain, str) else (abs(self.gain), newton)

    @model_validator(mode="after")
    def _drives(self) -> Joint:
        if self.command_law.kind != "force":
            raise ValueError(f"joint {self.name}: its force must be recorded; use kind: axes for a position servo")
        return self


class Carried(Strict):
    """A known mass that was put on a link.

    Attributes:
        mass: kg, of a body that is small beside its distance from the joints.
        link: that carries it, by the name of the model.
        centre: of it in the frame of the link's joint, m.
    """

    mass: float = Field(gt=0.0)
    link: str
    centre: tuple[float, float, float]


BEHIND = "behind `coupling`: "
"""How the note of a verdict begins whose causes sit on motors that move several joints."""


class ManipulatorDescription(ChainDescription):
    """A serial arm whose joints move together.

    Attributes:
        model: URDF or MJCF file with masses and inertias; joints of it that are not listed stay at rest at zero.
        inertias: `nominal`: those of the model are compared with the robot; `identified`: they are found from the data.
        joints: those recorded, in any order.
        coupling: motor travel = coupling * joint travel, one row for each joint of the list; without it every motor
            moves its own joint.
        effort_of: whether the efforts are those of the joints or of the motors behind the coupling.
        position_of: whether the positions are those of the joints or of the motors behind the coupling.
        gravity: at the base of the model, m/s^2; None: that of the model.
        carried: file name of a run, without its ending -> known mass that was put on the arm in it.
    """

    kind: Literal["manipulator"]
    model: str
    inertias: Literal["nominal", "identified"] = "nominal"
    joints: tuple[Joint, ...] = Field(min_length=1)
    coupling: tuple[Row, ...] | None = None
    effort_of: Literal["joints", "motors"] = "joints"
    position_of: Literal["joints", "motors"] = "joints"
    gravity: tuple[float, float, float] | None = None
    carried: Mapping[str, Carried] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _consistent(self) -> ManipulatorDescription:
        names, n = [j.name for j in self.joints], len(self.joints)
        if len(set(names)) < n:
            raise ValueError(f"joint names repeat: {', '.join(names)}")
        if self.carried and self.inertias == "identified":
            raise ValueError("what the arm carried is told beside `inertias: nominal` alone")
        if self.coupling is not None and [len(row) for row in self.coupling] != [n] * n:
            raise ValueError(f"coupling: a matrix of {n} rows and {n} columns is needed, one for each joint")
        return self

    @property
    def chain(self) -> Sequence[Joint]:
        """The joints: they are recorded like axes."""
        return self.joints

    @property
    def commanded(self) -> frozenset[str]:
        """Joints whose command stands for an effort that nobody measured."""
        return frozenset(j.name for j in self.joints if j.signals.effort is None and j.signals.command is not None)

    def servos(self, judged: Collection[str]) -> dict[str, float]:
        """Return joint -> gain of the joints whose servo has a stated law and whose effort was measured."""
        if self.coupling is not None:
            return {}
        known = [j for j in self.joints if j.name in judged and j.follows and j.signals.effort is not None]
        return {j.name: j.gain for j in known if isinstance(j.gain, float)}

    def named_files(self) -> tuple[str, ...]:
        """Return the file of the model."""
        return (self.model,)
