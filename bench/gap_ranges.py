"""How much held-out motion 90 % ranges of a verdict cover: simulated slides, and published machines where at hand.

    python bench/gap_ranges.py [FOLDER]
    python bench/gap_ranges.py --fresh 6

FOLDER holds the published data sets (`emps`, `rhoban_mx_drop`). With `--fresh N` the ranges of each slide are set on
its record, and counted on N further records with other motions: what is left of the spread is then no longer that of a
few held-out windows. The standard error is that of windows as the units that are drawn.
"""

import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from sher3_diagnosis import diagnose
from sher3_export.check import check as checking
from sher3_export.check import coverage as covering
from sher3_machines import described, import_case, open_case

sys.path.insert(0, str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
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


def fresh(number):
    """Set the ranges of each slide on one record, and count what they cover of `number` others with other motions."""
    shares = []
    usual = slides.reference
    for k, (seconds, coulomb, viscous, offset) in enumerate(SLIDES):
        runs = []
        for motion in range(number + 1):
            a, b = np.random.default_rng(900 + 10 * k + motion).uniform(0.0, 2.0 * np.pi, 2) if motion else (0.0, 0.4)
            slides.reference = lambda t, a=a, b=b: 0.04 * np.sin(1.3 * t + a) + 0.015 * np.sin(4.1 * t + b)
            runs.append(slides.run_of(slides.driven(seconds=seconds, coulomb=coulomb, viscous=viscous, offset=offset)))
        slides.reference = usual
        machine = slides.machine()
        verdict = diagnose(machine, runs[:1]).verdict
        share, error = counted(verdict, machine, runs)
        shares.append(share)
        print(
            f"slide {seconds:.0f} s {coulomb:g} N {viscous:g} N s/m {offset:+g} N: {share:6.1%} +- {error:.1%}",
            flush=True,
        )
    inside = sum(0.85 <= s <= 0.95 for s in shares)
    print(f"{len(shares)} slides: mean {np.mean(shares):.1%}, {inside} in 85 to 95 %")


def counted(verdict, machine, runs):
    """Return the share of all records but the first that the ranges cover, set on the first, and its standard error."""
    for module in (checking, covering):
        module.open_case = lambda path: (machine, runs)
    bench = covering.bench_of(verdict, Path("case"), None, {})
    ranges = covering.Ranges(covering.worlds_of(verdict, []))
    text = covering.export(verdict, "mjcf", covering.copied(bench.root), {}).text
    (found,) = covering.windows_of(bench, text, ranges, {}).values()
    of_window = np.array([len(x) for x in np.split(found.window, np.flatnonzero(np.diff(found.window)) + 1)])
    first = round(len(of_window) / len(runs))
    found = replace(found, held_out=found.window >= first)
    told = covering.inside(found, covering.scatter_of(found))[found.held_out]
    each = np.array([told[found.window[found.held_out] == w].mean() for w in np.unique(found.window[found.held_out])])
    return float(told.mean()), float(each.std() / np.sqrt(len(each)))


def main():
    if "--fresh" in sys.argv:
        return fresh(int(sys.argv[sys.argv.index("--fresh") + 1]))
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
