"""Two robots that give nearly the same data: one with an effect, one with what the library names in its place.

`python bench/gap_same_data.py [--effects base_tilt,...] [--json]`. The first robot is simulated with the effect, and
diagnosed without it; the second with the causes found, under the same noise, so that what differs is the effects alone.
Printed per effect: what was named, the first robot's gap, how far the two robots are apart where they differ most
(both rms over the floor of repeats), and the share of the gap that this is.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass

import numpy as np
from sher3_description import Robot, load_robot
from sher3_diagnosis.flow import find
from sher3_effects import plants
from sher3_effects.effects_file import to_effects
from sher3_gap.case.loading import signals_of
from sher3_gap.evidence import SherEvidence
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.sher import Sher
from sher3_sim import RunScatter
from sher3_sim.effect import PlantEffect

EFFECTS = {
    "base_tilt": ("tip", {}),
    "link_length_error": ("delta_1", {}),
    "platform_geometry_error": ("delta_1", {}),
    "encoder_offset": ("delta_1", {}),
    "structural_compliance": ("tip", {}),
    "link_compliance": ("tip", {}),
    "torque_constant": ("delta_2", {}),
    "payload_mass": ("delta_2", {}),
    "gravity_load": ("delta_2", {}),
    "backlash": ("delta_1", {}),
    "transmission_hysteresis": ("delta_1", {}),
    "transmission_ripple": ("delta_1", {}),
    "encoder_eccentricity": ("delta_1", {}),
    "friction_drift": ("delta_1", {}),
}
"""Effect -> where it sits, and parameters other than the plant's defaults."""
LABELS = [("loads", 3), ("postures", 3), ("reversals", 1), ("sweep", 1), ("task", 1)]
SEED = 5


@dataclass(frozen=True)
class Pair:
    """Two robots: the effect of the first, what stands for it in the second, and how far they are apart, in floors."""

    effect: str
    named: tuple[str, ...]
    gap: float
    apart: float
    where: str

    @property
    def share(self) -> float:
        """Share of the gap's power by which the robots differ."""
        return (self.apart / self.gap) ** 2


def evidence_of(robot: Robot, effects: Sequence[PlantEffect]) -> SherEvidence:
    """Simulate the excitations on a robot with effects; the same noise whatever the effects."""
    wanted = [(excite(label, robot), repeat) for label, repeats in LABELS for repeat in range(repeats)]
    runs = rehearse(robot, wanted, effects, seed=SEED, scatter=RunScatter(zero=0.05))
    (found,) = Sher(robot).gather([signals_of(run, robot, f"run {i}") for i, run in enumerate(runs)])
    return found


def apart(first: SherEvidence, second: SherEvidence) -> tuple[float, str]:
    """Return the largest rms difference of two robots' residuals over the first one's floor, and where it is."""
    found = {}
    for channel in first.channels:
        squares = []
        for a, b, floor in zip(first.data.residuals, second.data.residuals, first.floors, strict=True):
            if channel in a and channel in b:
                ok = a[channel].ok & b[channel].ok
                left = a[channel].relieved((a[channel].values - b[channel].values)[ok]) / floor[channel]
                squares.append(np.mean(left**2, axis=0))
        found[channel] = float(np.sqrt(np.max(np.mean(squares, axis=0))))
    where = max(found, key=found.__getitem__)
    return found[where], str(where)


def measure(robot: Robot, nominal: SherEvidence, effect: str) -> Pair:
    """Return the two robots of an effect."""
    site, parameters = EFFECTS[effect]
    real = evidence_of(robot, [plants()[effect](site, **parameters)])
    finding = find(Sher(robot), real, (effect,), lambda _: None)
    named = to_effects(finding.causes, robot) if finding.causes else []
    other = evidence_of(robot, named) if named else nominal
    distance, where = apart(real, other)
    return Pair(
        effect, tuple(f"{c.effect}:{c.actuator}" for c in finding.causes), apart(real, nominal)[0], distance, where
    )


def main() -> None:
    """Print the pairs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--effects", default=",".join(EFFECTS))
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    robot = load_robot()
    nominal = evidence_of(robot, [])
    pairs = [measure(robot, nominal, effect) for effect in arguments.effects.split(",")]
    if arguments.json:
        print(json.dumps([asdict(p) for p in pairs]))
        return
    print("| withheld | named in its place | gap, floors | the two robots apart, floors | share | where |")
    print("|---|---|---|---|---|---|")
    for p in pairs:
        print(f"| {p.effect} | {', '.join(p.named) or '-'} | {p.gap:.1f} | {p.apart:.2f} | {p.share:.2%} | {p.where} |")


if __name__ == "__main__":
    main()
