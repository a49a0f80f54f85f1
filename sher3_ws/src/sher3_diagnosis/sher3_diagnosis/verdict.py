"""The verdict of a diagnosis: typed, validated, written as the recorded-run contract's §8 lays down."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator
from sher3_common import read_text

SCHEMA = "sher3.verdict/3"
Schema = Literal["sher3.verdict/1", "sher3.verdict/2", "sher3.verdict/3"]
"""Schemas that are read: each is a superset of those before."""
Status = Literal["no_gap", "attributed", "under_excited", "outside_library"]


class _Model(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class Interval(_Model):
    """A value with its 95 % interval; `low` and `high` are None when too few runs carry one."""

    value: float
    low: float | None = None
    high: float | None = None


class Parameter(Interval):
    """A fitted parameter with its unit; of a choice that has words for its values, the word."""

    unit: str
    means: str | None = None


class Where(_Model):
    """One place of the signal chain at which the robot leaves the simulation.

    `gap`, `floor` and `unit` are of one component, the one with the largest ratio, named where there are several:
    `x y z` [m], `rx ry rz` [rad], `fx fy fz` [N], `tx ty tz` [N m].
    """

    stage: str
    actuator: str
    gap: float = Field(ge=0.0, description="rms of the nominal residual")
    floor: float = Field(ge=0.0, description="rms between repeats")
    unit: str
    component: str | None = None
    regime: str
    confidence: float = Field(ge=0.0, le=1.0)


class Cause(_Model):
    """An effect that explains a gap, with the effects that could not be told apart from it.

    `condition`: under which alone it acts, where runs were recorded under several; its parameters are then the change.
    """

    effect: str
    family: str
    stage: str
    actuator: str
    parameters: dict[str, Parameter]
    closure: Interval
    rivals: list[str] = []
    condition: str | None = None
    probability: float | None = Field(default=None, ge=0.0, le=1.0)


class Identified(_Model):
    """Constants of a link or joint beyond its model that were found from the data, by name, and are no causes."""

    actuator: str
    constants: dict[str, Parameter]


class Noise(_Model):
    """What single readings of a place differ by from the truth: white noise, rounding to `resolution` included.

    `reading`: what is read, such as `position`, `load` or `effort`. `resolution`: None where the readings show no step.
    """

    actuator: str
    reading: str
    deviation: float = Field(ge=0.0, description="standard deviation")
    resolution: float | None = Field(default=None, gt=0.0)
    unit: str


class Closure(_Model):
    """Closure with all causes added: at the first `where`, and at the tip when there was a tracker."""

    stage: Interval | None = None
    tip: Interval | None = None


class Residual(_Model):
    """What is left at the first `where` with all causes added."""

    gap: float = Field(ge=0.0)
    floor: float = Field(ge=0.0)
    unit: str


class Within(_Model):
    """A deviation that lies within its tolerance and so is no gap; the tolerance is three standard deviations."""

    quantity: str
    value: float
    tolerance: float = Field(gt=0.0)
    unit: str


class Imitation(_Model):
    """An effect that fits a gap although it is hardly its cause."""

    effect: str
    actuator: str
    closure: Interval


class Unexplained(_Model):
    """Where a gap lives that no effect of the library explains, what it looks like, and which effects imitate it."""

    stage: str
    actuator: str
    signature: str
    imitated_by: list[Imitation] = []


class NextExperiment(_Model):
    """The excitation that best tells the rivals apart.

    `added` is what the recorded runs had not, in words. `expected_odds` is the probability after it of the
    effect that is at work, on average over the rivals; None where it is not foretold. `alike`: the best bet and the
    effects that no rehearsed experiment tells from it, as `effect:actuator`: they are one answer.
    """

    excitation: str
    purpose: str
    separates: list[str]
    predicted_separation: float | None
    added: str = ""
    alike: list[str] = []
    expected_odds: float | None = Field(default=None, ge=0.0, le=1.0)


class Answer(_Model):
    """One answer to a place: causes that explain it together, or that the library lacks its cause, or no gap.

    With causes, `closure` and `residual` are of the place on held-out runs; None where too improbable to be fitted.
    """

    causes: list[Cause] = []
    answer: Literal["outside_library", "no_gap"] | None = None
    probability: float = Field(ge=0.0, le=1.0)
    closure: Interval | None = None
    residual: Residual | None = None

    @model_validator(mode="after")
    def _one(self) -> Answer:
        if bool(self.causes) == (self.answer is not None):
            raise ValueError("an answer is causes, outside_library or no_gap")
        return self


class Place(_Model):
    """A place with a gap and what one would bet on it, most probable first; `other` is what the answers leave of 1.

    `typicality` is the share of the labelled causes whose evidence is at least as unusual; None where nothing tells it.
    """

    stage: str
    actuator: str
    gap: float = Field(ge=0.0)
    floor: float = Field(ge=0.0)
    unit: str
    component: str | None = None
    answers: list[Answer]
    other: float = Field(default=0.0, ge=0.0, le=1.0)
    typicality: float | None = Field(default=None, ge=0.0, le=1.0)

    @property
    def bet(self) -> Answer | None:
        """The best explanation: the first answer with causes."""
        return next((a for a in self.answers if a.causes), None)

    @model_validator(mode="after")
    def _whole(self) -> Place:
        total = self.other + sum(a.probability for a in self.answers)
        if abs(total - 1.0) > WHOLE:
            raise ValueError(f"the probabilities of a place add up to {total:g}, not to 1")
        return self


WHOLE = 1e-3
"""How far the probabilities of a place may add up from one in a file, for their rounding."""


class Verdict(_Model):
    """What `diagnose` answers for one case."""

    schema_: Schema = Field(default="sher3.verdict/3", alias="schema")
    status: Status
    where: list[Where] = []
    places: list[Place] = []
    causes: list[Cause] = []
    closure: Closure = Closure()
    residual: Residual | None = None
    unexplained: Unexplained | None = None
    next_experiment: NextExperiment | None = None
    within_tolerance: list[Within] = []
    identified: list[Identified] = []
    noise: list[Noise] = []
    probabilities: dict[str, float] = {}
    costs: dict[str, float] = {}
    seconds: float = 0.0
    versions: dict[str, str] = {}
    notes: list[str] = []

    @property
    def one_answer(self) -> list[Answer]:
        """The answers to the first place that nothing tells from its best bet, itself first; none where it is alone."""
        alike = self.next_experiment.alike if self.next_experiment else []
        first = self.places[0].answers if self.places else []
        found = [a for a in first if a.causes and all(f"{c.effect}:{c.actuator}" in alike for c in a.causes)]
        return found if len(found) > 1 and found[0] is self.places[0].bet else []

    @property
    def unseparated_rivals(self) -> list[str]:
        """The rivals of the next experiment, where all are one answer: none that was rehearsed tells them apart."""
        one = {c.effect for a in self.one_answer for c in a.causes}
        rivals = self.next_experiment.separates if self.next_experiment else []
        return rivals if one >= set(rivals) else []

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True)

    @model_validator(mode="after")
    def _consistent(self) -> Verdict:
        if self.status == "no_gap" and (self.where or self.causes):
            raise ValueError("a no_gap verdict lists no place and no cause")
        if self.status != "no_gap" and not self.where:
            raise ValueError(f"a verdict {self.status!r} says where the gap is")
        if self.status == "attributed" and not self.causes:
            raise ValueError("an attributed verdict names at least one cause")
        if self.status == "under_excited" and not self.next_experiment:
            raise ValueError("an under_excited verdict proposes the next experiment")
        if self.status == "outside_library" and self.unexplained is None:
            raise ValueError("an outside_library verdict says what is unexplained")
        return self

    @field_validator("notes")
    @classmethod
    def _bounded(cls, notes: list[str]) -> list[str]:
        return notes[:50]

    def to_json(self) -> str:
        """Return the verdict as JSON text."""
        return self.model_dump_json(by_alias=True, indent=1)

    def write(self, path: Path) -> None:
        """Write the verdict to `path`."""
        path.write_text(self.to_json() + "\n", encoding="utf-8")

    @classmethod
    def read(cls, path: Path) -> Verdict:
        """Read and validate a verdict file; raises FileError, or `pydantic.ValidationError` naming each wrong field."""
        return cls.model_validate_json(read_text(path))
