"""The description of a serial arm; lengths are in m, angles in rad."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator
from sher3_machines.intake.fields import Column, Description, Strict
from sher3_machines.intake.poses import Pose


class Joint(Strict):
    """Row of a modified (Craig) Denavit-Hartenberg table; theta = q + offset."""

    name: str
    a: float
    d: float
    alpha: float
    offset: float = 0.0


class ArmDescription(Description):
    """A serial arm measured from outside; a DH table, or a URDF with its base and tip link.

    Attributes:
        joint_positions: (n, joints) of a table, or a column for each joint.
        poses: (n, 4, 4) of the measured body in the measuring frame, or its position with quaternion or Euler angles.
        positions: (n, 3) of a target on the last link, or three columns, where no orientation was measured.
        lengths: (n,) of a cable or a ball bar from a point that stays to a point on the last link.
        noise: standard deviation of a measured position or length, m.
        noise_rotation: the same of an orientation, rad; None: orientations only find the frames, positions are judged.
        joints: rows of the DH table.
        tip: from the last DH frame to the flange along z, m.
        urdf, base_link, tip_link: file, and the ends of the chain in it.
    """

    kind: Literal["arm"]
    joint_positions: Column | tuple[Column, ...]
    poses: Column | Pose | None = None
    positions: Column | tuple[Column, Column, Column] | None = None
    lengths: Column | None = None
    noise: float = Field(gt=0.0)
    noise_rotation: float | None = Field(default=None, gt=0.0)
    joints: tuple[Joint, ...] = ()
    tip: float = 0.0
    urdf: str | None = None
    base_link: str = ""
    tip_link: str = ""

    @model_validator(mode="before")
    @classmethod
    def _turned(cls, data: Any) -> Any:
        poses = data.get("poses") if isinstance(data, dict) else None
        if isinstance(poses, dict) and set(poses) == {"position"}:
            raise ValueError("poses without an orientation are `positions`, with the columns of `position`")
        return data

    @model_validator(mode="after")
    def _either(self) -> ArmDescription:
        if bool(self.joints) == (self.urdf is not None):
            raise ValueError("state either `joints` (DH table) or `urdf`")
        if sum(x is not None for x in (self.poses, self.positions, self.lengths)) != 1:
            raise ValueError("state either `poses`, `positions` or `lengths`")
        return self

    def named_files(self) -> tuple[str, ...]:
        """Return the path of the URDF, where the description names it."""
        return () if self.urdf is None else (self.urdf,)
