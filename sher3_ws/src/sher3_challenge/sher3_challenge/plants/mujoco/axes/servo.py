"""The drives: MuJoCo's own actuators where they are the contract's, a law per substep where they are not."""

from __future__ import annotations

import numpy as np

from sher3_challenge.plants.mujoco.axes.mjcf import SUBSTEPS
from sher3_challenge.plants.mujoco.axes.model import Machine
from sher3_challenge.plants.mujoco.axes.parts import AXES, Array, Axis, Drive
from sher3_challenge.plants.mujoco.engine import mujoco

LAG_POLES = (0.8, 0.2)
"""Shares of a drive's lag in the two poles of its filter."""


class Servos:
    """All drives and the laws that act on the motors, advanced one tick at a time."""

    def __init__(self, axes: list[Axis], machine: Machine, held: Array, step: float) -> None:
        self.axes, self.machine, self.step = axes, machine, step
        model, data = machine.model, machine.data
        self.model, self.data = model, data
        names = {model.actuator(i).name: i for i in range(model.nu)}
        self.kp = np.array([a.kp for a in axes])
        self.ki = np.array([a.ki for a in axes])
        self.scale = np.array([a.torque_gain for a in axes])
        self.demand = np.zeros(AXES)
        self.own = [j for j, a in enumerate(axes) if a.drive is None]
        self.push_on = [j for j, a in enumerate(axes) if a.pushes]
        self.level_on = [j for j, a in enumerate(axes) if a.levels]
        self.proportional = [names[f"p{j}"] for j in self.own]
        self.integral = [names[f"i{j}"] for j in self.own]
        self.state = [int(model.actuator_actadr[i]) for i in self.integral]
        self.motor = np.array(machine.motor)
        self.base = model.dof_frictionloss[self.motor].copy()
        self.special = {
            j: LawDrive(a.drive, a, float(held[j] / a.torque_gain), names[f"f{j}"], step)
            for j, a in enumerate(axes)
            if a.drive is not None
        }
        self.plain = not (self.special or self.push_on or self.level_on)
        data.act[self.state] = data.qpos[self.motor[self.own]] + held[self.own] / (self.ki * self.scale)[self.own]
        self._levels(0.0)

    def reported(self, position: Array, speed: Array, state: Array, demand: Array) -> Array:
        """Return (n, 5) the forces the drives report at the ticks: what they make then, before a new demand acts.

        Args:
            position: (n, 5) of the motors, half a substep back as they are read.
            speed: (n, 5) of the motors.
            state: (n, na) MuJoCo's activations.
            demand: (n, 5) demands held until the tick.
        """
        force = self.kp * (demand - speed)
        force[:, self.own] += self.ki[self.own] * (state[:, self.state] - position[:, self.own])
        for j, drive in self.special.items():
            force[:, j] = drive.reports
        return force

    def now(self, position: Array, speed: Array) -> Array:
        """Return (5,) the forces the drives make at positions and speeds (5,) of the motors."""
        force = self.kp * (self.demand - speed)
        force[self.own] += self.ki[self.own] * (self.data.act[self.state] - position[self.own])
        for j, drive in self.special.items():
            force[j] = drive.reports[-1]
        return np.asarray(force)

    def tell(self) -> None:
        """Let the drives with a law of their own report; the others are read from MuJoCo's state."""
        for j, drive in self.special.items():
            drive.tell(float(self.demand[j]), float(self.data.qvel[self.motor[j]]))

    def advance(self, demand: Array, steady: bool, time: float) -> None:
        """Advance one tick under demands (SUBSTEPS, 5) that the drives hold; `steady` ones do not change within it."""
        d = self.data
        if steady and self.plain:
            d.ctrl[self.proportional] = d.ctrl[self.integral] = demand[0]
            mujoco.mj_step(self.model, d, nstep=SUBSTEPS)
        else:
            loads = d.qfrc_applied.copy()
            for i in range(SUBSTEPS):
                d.ctrl[self.proportional] = d.ctrl[self.integral] = demand[i, self.own]
                self._substep(demand[i], loads, time + i * self.step)
                mujoco.mj_step(self.model, d)
            d.qfrc_applied[:] = loads
        self.demand = demand[-1].copy()

    def _substep(self, demand: Array, loads: Array, time: float) -> None:
        d = self.data
        for j, drive in self.special.items():
            v = float(d.qvel[self.motor[j]])
            d.ctrl[drive.actuator] = self.scale[j] * drive.force(float(demand[j]), v)
        for j in self.push_on:
            i = self.motor[j]
            q, v = float(d.qpos[i]), float(d.qvel[i])
            d.qfrc_applied[i] = loads[i] + sum(push(q, v, time) for push in self.axes[j].pushes)
        if self.level_on:
            self._levels(time)

    def _levels(self, time: float) -> None:
        d = self.data
        for j in self.level_on:
            i = self.motor[j]
            q, v = float(d.qpos[i]), float(d.qvel[i])
            level = sum(law(q, v, time) for law in self.axes[j].levels)
            self.model.dof_frictionloss[i] = max(1e-9, self.base[j] + level)


class LawDrive:
    """A drive with a clamp, a lag of its force, or heat that costs it force; the rest is the contract's."""

    def __init__(self, law: Drive, axis: Axis, held: float, actuator: int, step: float) -> None:
        self.law, self.kp, self.ki, self.actuator, self.step = law, axis.kp, axis.ki, actuator, step
        self.xi = held / axis.ki
        self.first = self.second = held
        self.heat = 0.0
        self.reports: list[float] = []

    def tell(self, demand: float, v: float) -> None:
        """Note the force the drive makes now."""
        self.reports.append(self._now(demand, v))

    def _now(self, demand: float, v: float) -> float:
        return self.second if self.law.lag > 0.0 else self._clamped(self._raw(demand, v))

    def _raw(self, demand: float, v: float) -> float:
        return self.kp * (demand - v) + self.ki * (self.xi - 0.5 * self.step * v)  # the integral half a step back

    def _clamped(self, force: float) -> float:
        return min(self.law.limit, max(-self.law.limit, force))

    def force(self, demand: float, v: float) -> float:
        """Return the force during the next substep, and advance integral, lag and heat."""
        error, step = demand - v, self.step
        raw = self._raw(demand, v) + 0.5 * step * self.ki * error  # the integral in the middle of the step
        force = self._clamped(raw)
        if force == raw or error * raw < 0.0:
            self.xi += error * step
        if self.law.lag > 0.0:
            slow, fast = (step / (step + share * self.law.lag) for share in LAG_POLES)
            self.first += slow * (force - self.first)
            self.second += fast * (self.first - self.second)
            force = self.second
        if self.law.droop > 0.0:
            self.heat += step * ((force / self.law.rated) ** 2 - self.heat / self.law.cooling)
            force *= max(0.2, 1 - self.law.droop * self.heat)
        return force
