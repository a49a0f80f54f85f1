"""A run of a serial arm with the forces that its model asks for, as the effects and the engine see it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from scipy.ndimage import maximum_filter1d
from sher3_diagnosis.channel import Array, Mask
from sher3_diagnosis.filter import settled
from sher3_effects.view import NominalAxis

from sher3_chain.chain.view import AROUND_STOP, LEAD_OF_STROKE, SLIP, ChainView, Loads, held_beside
from sher3_chain.manipulator.description import Joint
from sher3_chain.manipulator.encoders import crossing
from sher3_chain.manipulator.model import PARAMETERS, ROUNDED, ArmModel, point_inertia
from sher3_chain.manipulator.signals import JointSignals
from sher3_chain.readings.level import at_a_level, off
from sher3_chain.readings.orders import orders_in

AROUND_IMPACT = 2
"""Samples of the residual grid around one at which a gap is crossed: the filter smears the impact at its end."""
LINKS_OF_PAYLOAD = 4
"""Leading inertial parameters of a body that a payload changes linearly: its mass, and mass times centre."""
DEVELOPED = 0.95
"""Share of its full size above which a soft dry friction of MuJoCo no longer depends on the exact speed."""


class MotionView(ChainView):
    """A run of k joints with their nominal forces; on the side of the motors where a transmission couples them.

    Attributes:
        links: signals of the joints with the positions of the links.
        model: of the arm.
        coupling: motor travel = coupling * joint travel, (k, k).
        inertia: moved by each joint in the middle posture, (k,).
        shares: (k,) by which the model's forces are multiplied: 1, or units of the recorded effort per newton metre
            where the gain was found from the data.
    """

    joints: Sequence[Joint]

    def __init__(
        self,
        run: JointSignals,
        links: JointSignals,
        joints: Sequence[Joint],
        model: ArmModel,
        coupling: Array,
        shares: Array,
    ) -> None:
        super().__init__(run, joints)
        self.links = links
        self.model = model
        self.coupling = coupling
        self.shares = shares
        self._payload: dict[tuple[str, tuple[float, ...]], dict[str, Array]] = {}
        self._orders: dict[tuple[str, int], list[float]] = {}
        self._columns: dict[str, Array] = {}

    # what the effects read

    def axis(self, site: str) -> NominalAxis:
        """Return the nominal constants of a joint."""
        return self._axes[self.row(site)]

    @cached_property
    def _axes(self) -> list[NominalAxis]:
        alone = np.array_equal(self.coupling, np.eye(len(self.joints)))
        laws = [(j.command_law.position_gain or 0.0) * (j.by_its_law and alone) for j in self.joints]
        each = zip(self.joints, self.inertia, self.tops, laws, self.shares, strict=True)
        return [
            NominalAxis(
                float(m), max(j.viscous, SLIP), self.lead(j.name), float(top), follows=law, of_step=k * j.step_inertia
            )
            for j, m, top, law, k in each
        ]

    def lead(self, site: str) -> float:
        """Return the travel per motor revolution, m or rad; what stands for it where it is not known."""
        row = self.row(site)
        stated = self.joints[row].lead
        if stated is not None:
            return stated
        return LEAD_OF_STROKE * max(float(np.ptp(self.run.motor[:, row])), self.joints[row].encoder_resolution)

    def payload(self, link: str, centre: tuple[float, float, float]) -> dict[str, Array]:
        """Return joint -> (g, 4) force: per kg at the joint of a link, and per kg m of its centre.

        Args:
            link: that carries the payload.
            centre: near which its mass is taken to lie, m, in the frame of the link's joint. The inertia of a point
                mass is h h^T / m, with h its mass times centre: it is linear in both about a centre c, where it is
                c h^T + h c^T - m c c^T.
        """
        if (link, centre) not in self._payload:
            own = point_inertia(np.array(centre))
            both = [point_inertia(np.array(centre) + e) - own - point_inertia(e) for e in np.eye(3)]
            law = np.vstack([np.eye(LINKS_OF_PAYLOAD), np.column_stack([-own, *both])])
            columns = self._columns_of(link)
            forces = (columns.reshape(-1, PARAMETERS) @ law).reshape(*columns.shape[:2], LINKS_OF_PAYLOAD)
            self._payload[link, centre] = self._forces_by_joint(forces)
        return self._payload[link, centre]

    def link(self, link: str) -> dict[str, Array]:
        """Return joint -> (g,) force that a link, as its model has it, needs of every joint."""
        own = self.model.of(link)
        need = self._forces_by_joint(self.regressor_of_joints[..., own] @ self.model.inertial[own, None])
        return {joint: force[:, 0] for joint, force in need.items()}

    def per_inertial(self, link: str) -> dict[str, Array]:
        """Return joint -> (g, 10) force per inertial parameter of a link."""
        return self._forces_by_joint(self.regressor_of_joints[..., self.model.of(link)])

    def orders(self, joint: str, count: int) -> list[float]:
        """Return the periods per turn that stand out in what the model leaves of a joint's effort, the strongest first.

        Args:
            joint: whose effort is looked at.
            count: of them at most.
        """
        if (joint, count) not in self._orders:
            row = self.row(joint)
            ok = self.in_motion(row)
            left = self.effort[:, row] - self.inertial[:, row]
            self._orders[joint, count] = orders_in(left[ok], self.position[ok, row], self.velocity[ok, row], count)
        return self._orders[joint, count]

    def _columns_of(self, link: str) -> Array:
        """Return the force per inertial parameter of a link on every joint, (g, k, 10), side by side in memory."""
        if link not in self._columns:
            self._columns[link] = np.ascontiguousarray(self.regressor_of_joints[..., self.model.of(link)])
        return self._columns[link]

    def _forces_by_joint(self, forces: Array) -> dict[str, Array]:
        """Return joint -> (g, p) of forces on the joints (g, k, p), as the motors feel them; those that feel any."""
        felt = self._on_motors(forces) * self.shares[:, None]
        most = np.sqrt(np.einsum("gjp,gjp->j", felt, felt))
        return {name: felt[:, row] for row, name in enumerate(self.model.names) if most[row] > ROUNDED * most.max()}

    @cached_property
    def path(self) -> Loads:
        """Weight of the arm itself on every joint along the motion, (g, k); that of a known mass acts from outside."""
        own = self._weight_of(replace(self.model, carried=None))
        return Loads(own, own - (own if self.model.carried is None else self._weight_of(self.model)))

    def _weight_of(self, model: ArmModel) -> Array:
        return self._on_motors(model.weight(self._joint_position)[..., None])[..., 0] * self.shares

    @cached_property
    def effort(self) -> Array:
        """Recorded effort on the residual grid, (g, k)."""
        assert self.run.effort is not None
        return self.run.to_grid(self.run.effort)

    @cached_property
    def rigid(self) -> Array:
        """Force that the rigid bodies of the model need on every motor, (g, k), N or N m."""
        step = np.array([j.step_inertia for j in self.joints])
        return self._on_motors(self.model.needed(*self._link_motion)[..., None])[..., 0] + step * self.acceleration

    @cached_property
    def inertial(self) -> Array:
        """Nominal force that the measured motion needs, (g, k), in the unit of the effort."""
        viscous = np.array([max(j.viscous, SLIP) for j in self.joints])
        return self.shares * (self.rigid + self.lost) + viscous * self.velocity

    @cached_property
    def lost(self) -> Array:
        """Force that the losses of an MJCF model need on every motor, (g, k), N or N m.

        Dry friction turns between two samples of the grid: it is computed for every sample and filtered as efforts are.
        """
        losses, run = self.model.losses, self.links
        if losses is None:
            return np.zeros_like(self.velocity)
        dry = run.to_grid(self._dry)
        return self._on_motors((dry + losses.in_motion(*self._link_motion[:2]))[..., None])[..., 0]

    @cached_property
    def _dry(self) -> Array:
        """Force that dry friction of an MJCF model needs on every joint, for every sample of the run, (n, k)."""
        losses, run, back = self.model.losses, self.links, np.linalg.inv(self.coupling).T
        if losses is None:
            return np.zeros_like(run.smooth)
        q, v = (x @ back for x in (run.smooth, run.velocity))
        a = np.gradient(v, run.period, axis=0)
        return run.over_rows(lambda late: losses.dry(q, v + late * a, a))

    @cached_property
    def _link_motion(self) -> tuple[Array, Array, Array]:
        """Position, velocity and acceleration of the joints on the residual grid, (g, k) each."""
        run, back = self.links, np.linalg.inv(self.coupling).T
        motion = (run.smooth[run.grid], run.velocity[run.grid], run.to_grid(run.acceleration))
        q, v, a = (x @ back for x in motion)
        return q, v, a

    @property
    def _joint_position(self) -> Array:
        return self._link_motion[0]

    @cached_property
    def regressor(self) -> Array:
        """Force per inertial parameter on every motor, (g, k, 10 links)."""
        return self._on_motors(self.regressor_of_joints)

    @cached_property
    def regressor_of_joints(self) -> Array:
        """Force per inertial parameter on every joint, (g, k, 10 links)."""
        return self.model.regressor(*self._link_motion)

    def _on_motors(self, forces: Array) -> Array:
        """Bring forces on the joints (g, k, p) to the motors: tau_joint = coupling^T tau_motor."""
        alone = np.array_equal(self.coupling, np.eye(len(self.coupling)))
        return forces if alone else np.einsum("ji,gjp->gip", np.linalg.inv(self.coupling), forces)

    @cached_property
    def inertia(self) -> Array:
        """Inertia that each joint moves in the middle posture, (k,)."""
        return self.shares * np.diag(self.model.inertia_matrix(np.median(self._joint_position, axis=0)))

    def inertia_matrix(self, samples: int | Array) -> Array:
        """Return motor force by motor acceleration in the postures of samples of the residual grid, (..., k, k)."""
        back = np.linalg.inv(self.coupling)
        return np.asarray(back.T @ self.model.inertia_matrix(self._joint_position[samples]) @ back)

    # which samples can be judged

    def in_motion(self, row: int) -> Mask:
        """Return (g,) True where the force balance of a joint can be judged: well inside a stretch of its motion."""
        still = settled(self.moving[:, row] & ~self.at_a_level[:, row] & ~self.turning[:, row], 1)
        return self.run.inner & still & ~self.impacts & settled(~self.at_a_stop[:, row], AROUND_STOP)

    @cached_property
    def at_a_stop(self) -> Mask:
        """(g, k) True where a joint lies beyond the range that its model leaves it: there a stop pushes it back."""
        ranges = np.array([j.range or own for j, own in zip(self.joints, self.model.ranges, strict=True)])
        return np.asarray(self.beyond(self._joint_position, ranges) @ (np.linalg.inv(self.coupling) != 0.0))

    @cached_property
    def impacts(self) -> Mask:
        """(g,) True where the link of any joint flies across a gap; the impact at its end shakes all of them."""
        flying = np.any([crossing(self.run, row) for row in range(len(self.joints))], axis=0)
        return ~settled(~flying, AROUND_IMPACT)

    @cached_property
    def at_a_level(self) -> Mask:
        """(g, k) True where an effort lies flat at its largest reading, or its drive is off."""
        effort = self.run.effort
        assert effort is not None
        return np.column_stack([at_a_level(x) | off(x) | (not x.any()) for x in effort.T])[self.run.grid]

    @cached_property
    def moving(self) -> Mask:
        """(g, k) True where a joint moves: at rest friction takes any value, and the force balance says nothing.

        Nor does it where a joint is held and trembles while others of its kind move far.
        """
        run, half = self.run, max(1, self.run.stride)
        before = run.smooth[np.maximum(run.grid - half, 0)]
        after = run.smooth[np.minimum(run.grid + half, run.ticks - 1)]
        held = held_beside(np.ptp(run.smooth, axis=0).tolist(), [joint.motion for joint in self.joints])
        return (np.abs(after - before) > np.array([j.encoder_resolution for j in self.joints])) & ~held

    @cached_property
    def turning(self) -> Mask:
        """(g, k) True where the soft dry friction of an MJCF model turns: there it follows the noise of the encoder."""
        if self.model.losses is None:
            return np.zeros_like(self.velocity, dtype=bool)
        between = np.abs(self._dry) < DEVELOPED * self.model.losses.full
        near = maximum_filter1d(between, 2 * self.run.stride + 1, axis=0)[self.run.grid]
        return near @ (np.linalg.inv(self.coupling) != 0.0)

    # what the engine reads

    def quantities(self, site: str) -> dict[str, Array]:
        """Return quantity, of `sher3_diagnosis.effect.INPUTS`, -> (g, k) columns, as a joint feels them."""
        row = self.row(site)
        needed = self.inertial[:, [row]]
        return self.travelled(row) | {
            "weight": self.path.gravity[:, [row]],
            "posture": self.position,
            "acceleration": self.acceleration,
            "force": needed,
            "loading": self.gone_through(needed[:, 0]),
        }

    def everything(self) -> Array:
        """Return (g, k) everything that was recorded of the whole arm but its efforts."""
        return np.hstack([self.position, self.velocity, np.sign(self.velocity) * self.moving, self.acceleration])
