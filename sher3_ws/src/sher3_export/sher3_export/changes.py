"""From the causes of a verdict to constants of the equation of motion of a joint, whatever the target calls them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sher3_diagnosis.verdict import Cause, Identified, Noise, Parameter
from sher3_diagnosis.words import words
from sher3_effects import pages
from sher3_effects.page import CONSTANTS, NOISE

KINDS = ("axis", "servo", "joint", "arm", "table", "law", "robot")
"""Kinds of machine whose pages say which constant a parameter sets."""
NO_FORCE = ("A", "V", "%", "count", "eu")
"""How the units begin of forces that nobody made newtons."""
IDENTIFIED = "identified"
"""What stands for the effect of a constant that is no cause."""
READINGS = "readings"
"""What stands for the effect of the noise of readings."""
FORCES = ("coulomb", "static", "offset", "arm")
"""Constants that a servo without a recorded force gives in units of its stiffness, m or rad."""


@dataclass(frozen=True)
class Change:
    """One constant of one joint that the machine has beyond its model.

    Attributes:
        joint: name of the joint, or of the place of the cause.
        constant: of `sher3_effects.page.CONSTANTS`; of a cause that sets none the parameter's own name.
        value, low, high: what it is, and its interval, SI units; None where the verdict has no interval.
        unit: of the value.
        effect: the cause it comes from, or `IDENTIFIED`.
    """

    joint: str
    constant: str
    value: float
    low: float | None
    high: float | None
    unit: str
    effect: str

    @property
    def over_stiffness(self) -> bool:
        """Whether a force is given in units of the servo's stiffness."""
        return self.constant in FORCES and self.unit in ("m", "rad")

    def __str__(self) -> str:
        between = "" if self.low is None or self.high is None else f" ({self.low:.4g} to {self.high:.4g})"
        what = CONSTANTS.get(self.constant, words(self.constant).lower())
        return f"{self.effect} on {self.joint}: {what} {self.value:.6g} {self.unit}{between}"


@dataclass(frozen=True)
class NotExpressed:
    """What a target cannot express.

    Attributes:
        effect, joint: the cause and its place.
        constant: of `CONSTANTS`; empty for a cause that is no constant of a joint.
        value: SI units; None for a whole cause.
        reason: why, one clause.
    """

    effect: str
    joint: str
    constant: str
    value: float | None
    reason: str

    def __str__(self) -> str:
        what = "" if self.value is None else f" ({CONSTANTS[self.constant]} {self.value:.6g})"
        return f"{self.effect} on {self.joint}{what}: {self.reason}"


def changes_of(
    causes: Sequence[Cause], joints: Mapping[str, str] | None = None, own: bool = False
) -> tuple[list[Change], list[NotExpressed]]:
    """Return the numbers that causes set, constants of a joint or their own, and the causes of which none can be used.

    Args:
        causes: of a verdict.
        joints: axis of the verdict -> joint of the model, where their names differ.
        own: whether the model has its forces and masses in the unit of the recorded effort, as the verdict has.
    """
    changes: list[Change] = []
    left_out: list[NotExpressed] = []
    for cause in causes:
        if cause.condition is not None:
            left_out.append(_whole(cause, joints, f"it acts under {cause.condition} alone; a model has none"))
            continue
        unit = next((p.unit for p in cause.parameters.values() if p.unit.startswith(NO_FORCE)), None)
        if unit is not None and not own:
            left_out.append(_whole(cause, joints, f"it is in {unit}: state the gain of the drive, N or N m per unit"))
            continue
        joint = (joints or {}).get(cause.actuator, cause.actuator)
        known = constants_of(cause)
        known = known if known.keys() & cause.parameters.keys() else {name: name for name in cause.parameters}
        changes += [_change(cause.effect, joint, known[n], p) for n, p in cause.parameters.items() if n in known]
    return changes, left_out


def identified_changes(found: Sequence[Identified], joints: Mapping[str, str] | None = None) -> list[Change]:
    """Return the constants that were identified and are no causes; `joints` as in `changes_of`."""
    named = [((joints or {}).get(x.actuator, x.actuator), x) for x in found]
    return [_change(IDENTIFIED, joint, name, p) for joint, x in named for name, p in x.constants.items()]


def noise_changes(noise: Sequence[Noise], joints: Mapping[str, str] | None = None) -> list[Change]:
    """Return noise and step of the readings that are in SI units; `joints` as in `changes_of`."""
    return [
        Change((joints or {}).get(x.actuator, x.actuator), f"{kind}_{x.reading}", value, None, None, x.unit, READINGS)
        for x in noise
        if not x.unit.startswith(NO_FORCE)
        for kind, value in (("noise", x.deviation), ("resolution", x.resolution))
        if value is not None and f"{kind}_{x.reading}" in NOISE
    ]


def in_words(changes: Sequence[Change]) -> list[str]:
    """Return a sentence for each change, and one for the noise of all readings."""
    noisy = dict.fromkeys(x.joint for x in changes if x.effect == READINGS)
    told = [f"noise of the readings of {', '.join(noisy)}"] if noisy else []
    return [*(str(x) for x in changes if x.effect != READINGS), *told]


def _whole(cause: Cause, joints: Mapping[str, str] | None, reason: str) -> NotExpressed:
    return NotExpressed(cause.effect, (joints or {}).get(cause.actuator, cause.actuator), "", None, reason)


def constants_of(cause: Cause) -> Mapping[str, str]:
    """Return parameter -> constant of a cause: of the form of its page that knows most of its parameters."""
    forms = [page.on_axis for kind in KINDS for page in pages(kind) if page.id == cause.effect]
    return max(forms, key=lambda form: len(form.keys() & cause.parameters.keys()), default={})


def _change(effect: str, joint: str, constant: str, p: Parameter) -> Change:
    low, high = (None if x is None else float(x) for x in (p.low, p.high))
    return Change(joint, constant, float(p.value), low, high, p.unit, effect)
