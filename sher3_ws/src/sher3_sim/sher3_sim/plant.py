"""The live plant: one control period per call."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from sher3_common.compiled import direct
from sher3_description import Robot
from sher3_description.contract import REFERENCE_TEMPERATURE

from sher3_sim.effect import PlantEffect, with_effects
from sher3_sim.errors import InputError
from sher3_sim.kernel import robot as kernel
from sher3_sim.kernel.axis import AXIS_STATE, propagators
from sher3_sim.scatter import RunScatter

Vector = NDArray[np.float64]


class Reading(NamedTuple):
    """What the sensors say at one tick.

    Attributes:
        motor_position: Motor encoders (5,) [m, rad].
        motor_velocity: Difference of the last two motor readings over the period (5,) [m/s, rad/s].
        effort: Effort reported by the drives (5,) [N, N m].
        load_position: Load encoders (5,) [m, rad].
        demand: Mean velocity demand that the drives executed in the period that ends now (5,) [m/s, rad/s].
        wrench: Force sensor in {f} (6,) [N, N m].
        tracker: Tip position [m] and quaternion (x, y, z, w) in {b}, (7,); None between two samples of the tracker.
        temperature: Temperature of the structure [degC].
    """

    motor_position: Vector
    motor_velocity: Vector
    effort: Vector
    load_position: Vector
    demand: Vector
    wrench: Vector
    tracker: Vector | None
    temperature: float


def checked(name: str, values: ArrayLike, shape: tuple[int, ...]) -> Vector:
    """Return values as a contiguous float array of the given shape.

    Raises:
        InputError: no numbers, wrong shape, or a value that is not finite.
    """
    try:
        array = np.ascontiguousarray(values, dtype=np.float64)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{name} is no array of numbers", value=repr(values)[:80], limit=shape) from error
    if array.shape != shape:
        raise InputError(
            f"{name} has the wrong shape", value=array.shape, limit=shape, remedy="one row per actuator order"
        )
    if not np.isfinite(array).all():
        bad = array[~np.isfinite(array)][0]
        raise InputError(
            f"{name} is not finite", value=float(bad), limit="finite", remedy="stop the source of the command"
        )
    return array


class Plant:
    """A simulated robot that its caller steps; the same seed and inputs always give the same readings."""

    def __init__(
        self,
        robot: Robot,
        effects: Iterable[PlantEffect] = (),
        seed: int = 0,
        *,
        temperature: float = REFERENCE_TEMPERATURE,
        scatter: RunScatter | None = None,
    ) -> None:
        """Build the plant with effects in it and put it at rest at zero position.

        Raises:
            EffectError: an effect does not fit the robot.
        """
        self.temperature = temperature
        self.seed = seed
        self._robot, self._scatter = robot, scatter
        self._take_effects(effects)
        self._command, self._wrench, self._flat = np.zeros(5), np.zeros(6), np.zeros(kernel.READING_SIZE)
        self.reset(np.zeros(5))

    def _take_effects(self, effects: Iterable[PlantEffect]) -> None:
        self.parameters = with_effects(self._robot, effects)
        if self._scatter is not None:
            self.parameters = self._scatter.apply(self.parameters, self.seed)
        step = float(self.parameters.body["period"][0]) / self.parameters.substeps
        self._maps = propagators(self.parameters.axis, step)
        self._fixed = (self.parameters.axis, self.parameters.body[0], self.parameters.geometry)

    def exchange(self, effects: Iterable[PlantEffect]) -> None:
        """Go on from where the robot is with these effects instead of the present ones.

        An effect that moves an axis at rest, such as an offset of an encoder, does so at the next step.

        Raises:
            EffectError: an effect does not fit the robot; the plant keeps those it has.
        """
        self._take_effects(effects)
        self.parameters.body["temperature"] = self.temperature
        self._bind()

    def reset(self, q_ref: ArrayLike, wrench: ArrayLike | Sequence[float] = (0.0,) * 6) -> Reading:
        """Put the robot at rest at `q_ref` (5,) under a contact wrench (6,) at the tip in {b}, held by its drives.

        Raises:
            InputError: wrong shape or not finite.
        """
        start, load = checked("q_ref", q_ref, (5,)), checked("wrench", wrench, (6,))
        self._axes = np.zeros(5, AXIS_STATE)
        self._body = np.zeros(1, kernel.BODY_STATE)
        self._body["seed"] = self.seed
        self._out = np.zeros(1, kernel.READING)
        self.parameters.body["temperature"] = self.temperature
        kernel.start(*self._fixed, self._axes, self._body[0], self._out[0], start, load)
        kernel.flatten(self._out[0], self._flat)
        self._bind()
        return self._reading()

    def _bind(self) -> None:
        """Bind the compiled step to parameters and state."""
        constants = (self.parameters.axis, self.parameters.body, np.array(self.parameters.geometry), self._maps)
        self._arguments = (*constants, self.parameters.substeps, self._axes, self._body, self._out)
        self._step = direct(
            kernel.step_flat, *self._arguments, self._command, self._wrench, REFERENCE_TEMPERATURE, self._flat
        )

    def step(self, velocity_command: ArrayLike, contact_wrench: ArrayLike | Sequence[float] = (0.0,) * 6) -> Reading:
        """Advance one control period and sample the sensors at its end.

        Args:
            velocity_command: (5,) sent to the drives at the beginning of the period [m/s, rad/s].
            contact_wrench: (6,) on the tip in {b} at the end of the period [N, N m].

        Raises:
            InputError: wrong shape or not finite; the plant has not moved.
        """
        _take("velocity_command", velocity_command, self._command)
        _take("contact_wrench", contact_wrench, self._wrench)
        self._step(*self._arguments, self._command, self._wrench, self.temperature, self._flat)
        return self._reading()

    @property
    def true_position(self) -> Vector:
        """(5,) true load positions, which no sensor reads."""
        return self._axes["load"].copy()

    @property
    def true_tip(self) -> tuple[Vector, Vector]:
        """Rotation (3, 3) and position (3,) [m] of the true tip in {b}."""
        return self._out[0]["tip_rotation"].copy(), self._out[0]["tip_position"].copy()

    def _reading(self) -> Reading:
        v = self._flat.copy()
        tracker = v[32:39] if v[31] else None
        return Reading(v[0:5], v[5:10], v[10:15], v[15:20], v[20:25], v[25:31], tracker, self.temperature)


def _take(name: str, values: ArrayLike, into: Vector) -> None:
    """Copy values into an array of their shape; the plain list of the running loop is checked without an array."""
    try:
        plain = type(values) in (list, tuple) and len(values) == len(into) and math.isfinite(sum(values))  # type: ignore[arg-type]
    except (TypeError, OverflowError):
        plain = False
    if plain:
        into[:] = values
    else:
        into[:] = checked(name, values, into.shape)
