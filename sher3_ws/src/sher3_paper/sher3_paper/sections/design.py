"""The design optimisation: the chosen design, constraints, optima, ranks and trends, in both readings."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from sher3_paper.comparison import Comparison, Section, Table, compare, computed
from sher3_paper.search.constraints import AS_STATED, REACH_ONLY, RELAXED, Constraints
from sher3_paper.search.design import CHOSEN, READINGS, Reading
from sher3_paper.search.optimise import PAPER_LAW, Search, best, search
from sher3_paper.tables import printed

COMMAND = "sher3 design"
SETS: dict[str, Constraints] = {"as stated": AS_STATED, "relaxed": RELAXED, "reach only": REACH_ONLY}


def design() -> Section:
    """Return the part on the design search."""
    found = {reading: search(reading=reading) for reading in READINGS}
    start = time.perf_counter()
    search()
    seconds = time.perf_counter() - start
    lines = _chosen_lines(found["circumradius"], found["midplane"])
    note = "960 designs, 432 positions each by symmetry, one core"
    lines.append(computed("time of the exhaustive search", "s", seconds, COMMAND, note))
    tables = [_constraint_table(found), _optimum_table(found), _trend_table(found)]
    text = (
        "L 60:2:90 mm, w 25:5:40 mm, psi 18:1:32 deg over the cylinder of 55 by 60 mm. GCI is the mean over the "
        "disc of sigma_min / sigma_max of the Jacobian, T_c the mean secant at 1 N m. Relaxed means: no limits of "
        "clearance and slider range, and swing measured about the best axis."
    )
    shown = found["circumradius"]
    figures: list[tuple[str, dict[str, Any]]] = [
        ("trends", {"found": shown}),
        ("pareto", {"found": shown, "sets": SETS}),
    ]
    return Section("design", "Design optimisation", text, lines, tables, figures)


def torque_for(found: Search, k: int, target: float) -> float:
    """Return the moment [N m] at which design k has the mean torsional compliance `target` [rad/(N m)].

    A pure power law makes T_c proportional to torque^(b - 1).
    """
    return float((target / found.compliance[k]) ** (1.0 / (PAPER_LAW.b - 1.0)))


def _chosen_lines(circum: Search, midplane: Search) -> list[Comparison]:
    values = printed()["optimisation"]
    k, j = circum.find(CHOSEN), midplane.find(CHOSEN)
    gci, target = values["gci"], values["torsional_compliance"]
    t_c, t_c_other = (float(np.degrees(f.compliance[i])) for f, i in ((circum, k), (midplane, j)))
    torque = torque_for(circum, k, np.radians(target))
    rank, count = circum.rank(k, circum.values.reaches)
    dominated = len(circum.dominating(k, circum.values.reaches))
    return [
        compare("GCI, circumradius", "1", gci, circum.index[k], 0.005, COMMAND),
        compare("GCI, mid-plane", "1", gci, midplane.index[j], 0.005, COMMAND, "the other reading of the radii"),
        compare("T_c at 1 N m, circumradius", "deg/(N m)", target, t_c, 0.0005, COMMAND, "torque not stated"),
        compare("T_c at 1 N m, mid-plane", "deg/(N m)", target, t_c_other, 0.0005, COMMAND, "torque not stated"),
        computed("torque that gives the printed T_c", "N m", torque, COMMAND, "circumradius"),
        computed("rank by GCI / T_c among designs that reach", "1", rank, COMMAND, f"of {count}"),
        computed("designs better in both objectives", "1", dominated, COMMAND, "among designs that reach"),
    ]


def _constraint_table(found: dict[Reading, Search]) -> Table:
    limits = printed()["optimisation"]
    rows = []
    for reading, result in found.items():
        k, v = result.find(CHOSEN), result.values
        met = {**AS_STATED.each(v), **Constraints(None, 0.030, None, None, np.radians(30.0)).each(v)}
        shown = {
            "reach": ("largest R + radius < L [mm]", (v.midplane_clearance[k] + 0.0275) * 1e3, 64),
            "clearance": ("r_b - r_p > [mm]", v.clearance[k] * 1e3, limits["clearance"]),
            "midplane_clearance": ("R > [mm]", v.midplane_clearance[k] * 1e3, limits["clearance"]),
            "stroke": ("slider range < [mm]", v.stroke[k] * 1e3, limits["stroke"]),
            "swing": ("swing about the centre direction < [deg]", np.degrees(v.swing[k]), limits["swing"]),
            "cone": ("swing about the best axis < [deg]", np.degrees(v.cone[k]), limits["swing"]),
        }
        for name, (text, value, limit) in shown.items():
            verdict = "met" if met[name][k] else "violated"
            rows.append([reading, text, f"{limit:g}", f"{value:.1f}", verdict, f"{int(met[name].sum())} of 960"])
        rows.append([reading, "all as stated", "", "", "", f"{int(AS_STATED.met(v).sum())} of 960"])
    columns = ["reading", "constraint", "limit", "chosen design", "chosen design is", "designs that meet it"]
    return Table("Constraints", columns, rows)


def _optimum_table(found: dict[Reading, Search]) -> Table:
    rows = []
    for reading, result in found.items():
        for name, constraints in SETS.items():
            front = len(result.pareto(constraints.met(result.values)))
            for objective, k in best(result, constraints).items():
                t_c = np.degrees(result.compliance[k])
                figures = [f"{result.index[k]:.3f}", f"{t_c:.3f}", front]
                rows.append([reading, name, objective, str(result.design(k)), *figures])
    columns = ["reading", "constraints", "objective", "design", "GCI", "T_c [deg/(N m)]", "designs on the Pareto front"]
    return Table("Optima", columns, rows)


def _trend_table(found: dict[Reading, Search]) -> Table:
    """Return what becomes of the claims about the figure: psi raises GCI and lowers T_c, L hardly matters."""
    rows = []
    for reading, result in found.items():
        shape = (16, 4, 15)
        index, compliance = result.index.reshape(shape), result.compliance.reshape(shape)
        rising, falling = np.diff(index, axis=2), np.diff(compliance, axis=2)
        rows.append([reading, "GCI rises with psi", f"{_share(rising > 0, rising):.1f} % of steps"])
        rows.append([reading, "T_c falls with psi", f"{_share(falling < 0, falling):.1f} % of steps"])
        for axis, name in ((0, "L"), (1, "w"), (2, "psi")):
            spreads = [_spread(values, axis) for values in (index, compliance)]
            rows.append([reading, f"mean spread over {name}", f"GCI {spreads[0]:.1f} %, T_c {spreads[1]:.1f} %"])
    return Table("Trends", ["reading", "claim or figure", "found"], rows)


def _share(flags: np.ndarray, values: np.ndarray) -> float:
    finite = np.isfinite(values)
    return 100.0 * float(flags[finite].mean())


def _spread(values: np.ndarray, axis: int) -> float:
    complete = np.isfinite(values).all(axis=axis)
    spread = (values.max(axis=axis) - values.min(axis=axis)) / values.mean(axis=axis)
    return 100.0 * float(spread[complete].mean())
