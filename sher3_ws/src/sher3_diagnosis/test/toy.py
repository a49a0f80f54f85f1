"""A machine small enough to work out by hand: one axis, one residual of a few samples, effects that are columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from sher3_diagnosis.channel import Array, Channel, Residual
from sher3_diagnosis.effect import Best, Effect, Shape, Signature
from sher3_diagnosis.evidence import Evidence, Motion
from sher3_diagnosis.fit.standardised import Standardised
from sher3_diagnosis.machine import Machine

AXIS = Channel("motor_mechanics", "axis")


@dataclass(frozen=True)
class ToyRun:
    """Values of the residual (n,) and what they may depend on (n,)."""

    excitation: str
    values: Array
    position: Array
    velocity: Array
    loaded: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=bool))
    warmth: Array = field(default_factory=lambda: np.zeros(0))


class ToyView:
    """What effects and regimes see of a run; the top speed is 1 m/s and a motor revolution is 1 m."""

    rate = 100.0
    temperature_known = True

    def __init__(self, run: ToyRun) -> None:
        self.run = run
        self.excitation = run.excitation
        self.loaded = run.loaded if len(run.loaded) else np.zeros(len(run.values), dtype=bool)
        self.warmth = run.warmth if len(run.warmth) else np.zeros(len(run.values))
        self.speed_share = np.abs(run.velocity)

    def motion(self, actuator: str) -> Motion | None:
        return Motion(self.run.position, self.run.velocity, 1.0, 1.0) if actuator == "axis" else None

    def inputs(self, actuator: str) -> Array:
        return np.column_stack([self.run.position, self.run.velocity])


class Column(Effect):
    """An effect that adds `size` times one quantity of the run."""

    stage = "motor_mechanics"
    explanation = "It adds one column."
    units: Mapping[str, str] = {"size": "N"}
    best = Best("steps", "steps show it")

    def __init__(self, name: str, family: str, quantity: str, **sheet: object) -> None:
        self.id, self.family, self.quantity = name, family, quantity
        for key, value in sheet.items():
            setattr(self, key, value)

    def signature(self, view: ToyView, site: str, shape: Shape) -> Signature:
        run = view.run
        value = {"one": np.ones_like(run.values), "direction": np.sign(run.velocity)}.get(self.quantity)
        value = getattr(run, self.quantity) if value is None else value
        return Signature({Channel(self.stage, site): value[:, None, None]})

    def parameters(self, shape: Shape, coefficients: Array) -> dict[str, float]:
        return {"size": float(coefficients[0])}

    def admissible(self, shape: Shape, coefficients: Array) -> bool:
        return bool(coefficients[0] > 0.0)


OFFSET = Column("offset", "inertia", "one", extends=())
DIRECTION = Column("direction", "friction", "direction")
SPEED = Column("speed", "friction", "velocity", siblings={"direction": "grows with speed"})


def evidence_of(runs: Sequence[ToyRun], floor: float = 1.0, **facts: object) -> Evidence:
    """Return evidence with one floor for all runs."""
    residuals = [{AXIS: Residual(r.values[:, None], np.ones(len(r.values), dtype=bool))} for r in runs]
    floors = [{AXIS: np.array([floor])} for _ in runs]
    data = Standardised([ToyView(r) for r in runs], residuals, floors)
    given = {"units": {AXIS: "N"}, "places": {"axis": ("axis",)}, **facts}
    return Evidence(excitations=[r.excitation for r in runs], data=data, **given)


def stroke(excitation: str = "sweep", n: int = 200, seed: int = 0, size: float = 0.0, law: str = "direction") -> ToyRun:
    """Return a back-and-forth motion whose residual is noise of one floor plus `size` floors of a law."""
    rng = np.random.default_rng(seed)
    phase = np.linspace(0.0, 4.0 * np.pi, n)
    position, velocity = np.sin(phase), np.cos(phase) * (0.5 if excitation == "slow" else 1.0)
    column = {"direction": np.sign(velocity), "velocity": velocity, "one": np.ones(n)}[law]
    return ToyRun(excitation, rng.normal(size=n) + size * column, position, velocity)


def case(size: float, law: str = "direction") -> list[ToyRun]:
    """Return six runs: two excitations, three repeats each."""
    labels = ("sweep", "slow")
    return [stroke(e, seed=10 * i + k, size=size, law=law) for i, e in enumerate(labels) for k in range(3)]


@dataclass(frozen=True)
class Toy(Machine[ToyRun, Evidence]):
    """The machine: its floor is known to be one."""

    effects_known: tuple[Effect, ...] = (OFFSET, DIRECTION, SPEED)

    def library(self) -> Sequence[Effect]:
        return self.effects_known

    def audit(self, runs: Sequence[ToyRun]) -> list[str]:
        return ["few runs"] if len(runs) < 3 else []

    def gather(self, runs: Sequence[ToyRun]) -> list[Evidence]:
        return [evidence_of(runs)]
