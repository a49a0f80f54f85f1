"""How much held-out motion 90 % ranges of a verdict cover: simulated slides, and published machines where at hand.

    python bench/gap_ranges.py [FOLDER]

FOLDER holds the published data sets (`emps`, `rhoban_mx_drop`).
"""

import sys
import tempfile
from pathlib import Path

import numpy as np
from sher3_diagnosis import diagnose
from sher3_export.check import check as checking
from sher3_export.check import coverage as covering
from sher3_machines import described, import_case, open_case

sys.path.insert(0, str(Path(__file__).parents[1] / "sher3_ws/src/sher3_machines/test"))
import slides

SLIDES = (
    (8.0, 8.0, 40.0, 0.0),
    (16.0, 8.0, 40.0, 0.0),
    (16.0, 3.0, 0.0, 0.0),
    (16.0, 0.0, 80.0, 0.0),
    (16.0, 12.0, 20.0, 5.0),
    (30.0, 6.0, 30.0, -3.0),
    (30.0, 15.0, 10.0, 2.0),
    (30.0, 2.0, 60.0, 0.0),
)
"""Seconds, dry friction (N), viscous friction (N/(m/s)) and constant force (N) of each simulated slide."""
PUBLISHED = {"emps": "DATA_EMPS.mat", "rhoban_mx_drop": "friction_1.json"}
"""Data set -> its file."""


def cover(name, machine, runs):
    """Diagnose, draw from the ranges, print what they cover of the motion that they were not set on."""
    for module in (checking, covering):
        module.open_case = lambda path: (machine, runs)
    verdict = diagnose(machine, runs).verdict
    found = covering.covered(verdict, Path(name), None, {})
    causes = ", ".join(c.effect for c in verdict.causes)
    for joint, share in found.coverage.items():
        print(f"{name:<34} {joint:<8} {share:6.1%}   {causes}", flush=True)
    return list(found.coverage.values())


def main():
    shares = []
    for seconds, coulomb, viscous, offset in SLIDES:
        rows = slides.driven(seconds=seconds, coulomb=coulomb, viscous=viscous, offset=offset)
        name = f"slide {seconds:.0f} s {coulomb:g} N {viscous:g} N s/m {offset:+g} N"
        shares += cover(name, slides.machine(), [slides.run_of(rows)])
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("none")
    for name, file in PUBLISHED.items():
        if (folder / name / file).is_file():
            with tempfile.TemporaryDirectory() as scratch:
                import_case([folder / name / file], described(Path(name)), Path(scratch) / name)
                shares += cover(name, *open_case(Path(scratch) / name))
    print(f"{len(shares)} motions: mean {np.mean(shares):.1%}, {sum(0.85 <= s <= 0.95 for s in shares)} in 85 to 95 %")


if __name__ == "__main__":
    main()
