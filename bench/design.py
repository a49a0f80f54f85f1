"""Time of the design search, compiled, beside the same computation through numpy's linear algebra.

python bench/design.py [--json] [--jobs N]
"""

from __future__ import annotations

import argparse
import json
import time

import numpy as np
from sher3_kinematics.deflection import DeltaDeflection
from sher3_paper.search.constraints import Workspace
from sher3_paper.search.optimise import PAPER_LAW, fine_grid, paper_grid, search, search_parallel


def numpy_seconds(designs: int = 20) -> float:
    """Return seconds per design of full gamma matrices and singular values over 432 positions, vectorised in numpy."""
    spiral = np.arange(432)
    radius, angle = Workspace().radius * np.sqrt((spiral + 0.5) / 432), spiral * np.pi * (3 - np.sqrt(5))
    centres = np.column_stack((radius * np.cos(angle), radius * np.sin(angle), np.zeros(432)))
    found = search()
    start = time.perf_counter()
    for k in np.flatnonzero(found.values.reaches)[:designs]:
        model = DeltaDeflection(found.design(int(k)).robot(), PAPER_LAW)
        model.torsional_compliance(centres, 1.0).mean()
        links = model.link_vectors(centres)[:, ::2]
        np.linalg.svd(links / links[..., 2:], compute_uv=False)
    return (time.perf_counter() - start) / designs


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--jobs", type=int, default=2, help="processes of the fine search")
    parser.add_argument("--fine", type=int, default=1_000_000, help="designs of the fine search")
    arguments = parser.parse_args()
    search()
    times = []
    for _ in range(5):
        start = time.perf_counter()
        search(paper_grid())
        times.append(time.perf_counter() - start)
    start = time.perf_counter()
    fine = search_parallel(fine_grid(arguments.fine), jobs=arguments.jobs)
    fine_seconds = time.perf_counter() - start
    figures = {
        "exhaustive_960_designs_432_positions_s": min(times),
        "numpy_per_960_designs_s": 960 * numpy_seconds(),
        "fine_designs": len(fine),
        "fine_jobs": arguments.jobs,
        "fine_s": fine_seconds,
    }
    if arguments.json:
        print(json.dumps(figures, indent=2))
    else:
        for name, value in figures.items():
            print(f"{name:42s} {value:.4g}")


if __name__ == "__main__":
    main()
