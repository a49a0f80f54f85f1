"""How well a parameter of the library's law can stand for a truth plant's own law: its shape alone, without noise.

    nice python bench/gap_labels.py --plant tables --draws 2

Each fault is put into a robot that is otherwise exactly as its file says, and run without noise, rounding or scatter,
in the size at which its gap is about ten times what the encoders' and sensors' resolution makes.
The library's page of that fault, and of what belongs to it, is fitted where the fault sits. Printed per parameter: how
far the best fit is from the number the plant calls by that name, and the share of the gap that this fit leaves. A robot
of the library's law with the fitted number gives the same data but for that share: no diagnosis can tell the two apart
by more, and no interval that is to hold the plant's number may be narrower.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from sher3_challenge.cases.calibrate import distinct_runs
from sher3_challenge.cases.plan import CasePlan, draw_plan
from sher3_challenge.plants.kinds import Kind
from sher3_challenge.plants.registry import plant_names, truth_plant
from sher3_challenge.score.intervals import SYNONYMS
from sher3_description import load_robot
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.attribute.polish import polished
from sher3_diagnosis.attribute.rivals import Attribution
from sher3_diagnosis.fit.fitting import Fit
from sher3_diagnosis.quantify.parameters import parameters
from sher3_effects import library
from sher3_gap.case.loading import signals_of
from sher3_gap.evidence import SherEvidence
from sher3_gap.sher import Sher

GAP = 10.0
"""Gap over floor to which a fault is scaled."""


class Row(NamedTuple):
    """One parameter: its relative distance from the plant's number, the share of the gap left, and gap over floor."""

    name: str
    error: float
    left: float
    ratio: float


def ideal(plan: CasePlan) -> tuple[SherEvidence, dict[str, float]]:
    """Return what is seen of the robot of the file with the plan's fault alone, and the fault's parameters."""
    robot = load_robot()
    plant = plan.truth.make(robot, 0, plan.faults, plan.climate, built=False, region=plan.region)
    runs = [signals_of(plant.run(run, ideal=True), robot, run.excitation.label) for run in distinct_runs(plan)]
    (evidence,) = Sher(robot).gather(runs)
    return evidence, plant.parameters()[0]


def fitted(evidence: SherEvidence, kind: Kind, site: str) -> Fit | None:
    """Return the best fit of a fault's page at a site, the last term, beside its company's; None where none shows."""
    candidates = Candidates(evidence, [])
    found: Fit | None = None
    for name in (*(n for n in kind.company if n == "gravity_load"), kind.effect):
        page = library()[name]
        sites = candidates.sites(page)
        found = candidates.best(page, site if site in sites else sites[0], found.terms if found else ())
    if found is None:
        return None
    return polished(evidence, Attribution(found, ((),) * len(found.terms), (1.0,) * len(found.terms))).fit


def shown(evidence: SherEvidence, found: Fit) -> tuple[float, float, float]:
    """Return the loss over the floor without and with a fit, and the gap over the floor, where the fit shows."""
    channels = found.terms[-1].channels
    gap, left = (sum(max(evidence.excess(c, f), 0.0) for c in channels) for f in (None, found))
    ratio = max(1.0 + evidence.excess(c) / max(evidence.samples(c), 1) for c in channels) ** 0.5
    return gap, left, ratio


def rows_of(plan: CasePlan) -> Iterator[Row]:
    """Yield one row per parameter that the plant names and the page states."""
    kind, site = plan.faults[0].kind, plan.faults[0].actuator
    evidence, true = ideal(plan)
    found = fitted(evidence, kind, site)
    if found is not None:
        larger = plan.faults[0].scaled_by(GAP / shown(evidence, found)[2])
        evidence, true = ideal(replace(plan, faults=(larger,)))
        found = fitted(evidence, kind, site)
    if found is None:
        return
    gap, left, ratio = shown(evidence, found)
    stated = {name.lower(): p.value for name, p in parameters(evidence, found, len(found.terms) - 1).items()}
    discrete = found.terms[-1].effect.discrete
    for name, number in true.items():
        known = [stated[s] for s in SYNONYMS.get(name, name).split() if s in stated and s not in discrete]
        if known and number:
            value = min(known[0], -known[0], key=lambda x: abs(x - number))
            yield Row(name, value / number - 1.0, left / max(gap, 1.0), ratio)


def main() -> None:
    """Print one line per parameter, then the quantiles."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--plant", choices=plant_names(), default="tables")
    parser.add_argument("--draws", type=int, default=1, help="robots for each kind of fault")
    parser.add_argument("--seed", type=int, default=70000)
    parser.add_argument("--only", default="", help="names of faults, parted by commas")
    asked = parser.parse_args()
    truth = truth_plant(asked.plant)
    names = asked.only.split(",") if asked.only else sorted(n for n, k in truth.library.items() if not k.exact)
    rows: list[Row] = []
    for i, name in enumerate(names * asked.draws):
        for row in rows_of(draw_plan(load_robot(), asked.seed + i, truth, kind="single", effect=name)):
            rows.append(row)
            text = f"{row.name}: {row.error:+.3f}, {row.left:.2%} left of {row.ratio:.1f} floors"
            print(f"{asked.plant} {asked.seed + i} {name} {text}", flush=True)
    report(asked.plant, [row for row in rows if row.ratio >= GAP / 2.0])


def report(plant: str, rows: list[Row]) -> None:
    """Print how far the numbers are off, of gaps of at least half the size aimed at."""
    if rows:
        errors = np.abs([row.error for row in rows])
        shares = ", ".join(f"{q:.0%} within {np.quantile(errors, q):.3f}" for q in (0.5, 0.9, 0.95))
        hidden = sum(abs(row.error) > 0.05 and row.left < 0.01 for row in rows)
        far = int(np.sum(errors > 0.05))
        print(f"{plant}: {shares}; off by more than 5 %: {far} of {len(rows)}, {hidden} of them with < 1 % left")


if __name__ == "__main__":
    main()
