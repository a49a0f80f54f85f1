"""A robot as it might have been built: effects drawn from tolerances, none chosen to meet a figure.

`as_built.yaml` is the first draw and the default robot of `sher3 benchtop`; docs/reference/benchtop.md reasons the
tolerances.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from sher3_effects.effects_file import effect_from_dict
from sher3_sim import PlantEffect

FILE = Path(__file__).parent / "as_built.yaml"
"""The robot of seed 0."""
SLIDERS = ("delta_1", "delta_2", "delta_3")


@dataclass(frozen=True)
class Tolerances:
    """One standard deviation each.

    Attributes:
        part: every coordinate of every ball centre, and every link's length [m]: ordinary machining and assembly.
        rail_lean: of a rail, per direction [rad].
        encoder_scale: of the linear encoders [1].
        structure, links: compliance over the paper's measured ones [1], not scattered.
    """

    part: float = 50e-6
    rail_lean: float = np.radians(0.25)
    encoder_scale: float = 1.5e-3
    structure: float = 1.0
    links: float = 1.0


def as_built(seed: int = 0, tolerances: Tolerances | None = None) -> list[PlantEffect]:
    """Return one robot's effects.

    The plant takes a leg's two links together: their mean length is off by part / sqrt(2); platform and slider balls,
    averaged over the pair, move the anchor by part; and the two links differ by sqrt(6) part, from both lengths
    and, along the links, four ball centres.
    """
    t, rng = tolerances or Tolerances(), np.random.default_rng(seed)
    effects: list[PlantEffect] = []
    for leg in SLIDERS:
        length, difference = t.part * np.array([np.sqrt(0.5), np.sqrt(6.0)]) * rng.standard_normal(2)
        x, y = t.part * rng.standard_normal(2)
        lean = t.rail_lean * rng.standard_normal(2)
        angle, azimuth = float(np.hypot(*lean)), float(np.arctan2(lean[1], lean[0]))
        effects += [
            _made("link_length_error", leg, length=float(length), difference=float(difference)),
            _made("platform_geometry_error", leg, x=float(x), y=float(y)),
            _made("rail_tilt", leg, angle=angle, azimuth=azimuth),
        ]
    for axis in (*SLIDERS, "tilt"):
        relative = t.encoder_scale * float(rng.standard_normal())
        effects.append(_made("encoder_scale", axis, relative=relative))
    return [
        *effects,
        _made("structural_compliance", "tip", fraction=t.structure),
        _made("link_compliance", "all", fraction=t.links),
    ]


def _made(effect: str, actuator: str, **parameters: float) -> PlantEffect:
    return effect_from_dict({"effect": effect, "actuator": actuator, "parameters": parameters})
