"""What a search of the designs found, as plain data and as text."""

from __future__ import annotations

from typing import Any

import numpy as np

from sher3_paper.errors import BadData, InfeasibleDesign
from sher3_paper.search.constraints import AS_STATED, REACH_ONLY, RELAXED, Constraints
from sher3_paper.search.design import CHOSEN, READINGS, Reading
from sher3_paper.search.optimise import Search, best

SETS: dict[str, Constraints] = {"stated": AS_STATED, "relaxed": RELAXED, "reach": REACH_ONLY}


def choices(reading: str, constraints: str) -> tuple[Reading, Constraints]:
    """Return the reading of the radii and the constraints by their names.

    Raises:
        BadData: there is no such name.
    """
    taken = next((name for name in READINGS if name == reading), None)
    if taken is None:
        raise BadData("reading", value=reading, limit=" or ".join(READINGS), remedy="choose one")
    if constraints not in SETS:
        raise BadData("constraints", value=constraints, limit=", ".join(SETS), remedy="choose one")
    return taken, SETS[constraints]


def summary(found: Search, constraints: Constraints, seconds: float) -> dict[str, Any]:
    """Return the result of a search that took `seconds` as plain data, with the paper's own design if it was tried."""
    met = constraints.met(found.values)
    front = found.pareto(met)

    def entry(k: int) -> dict[str, Any]:
        gci, t_c = float(found.index[k]), float(np.degrees(found.compliance[k]))
        return {"design": str(found.design(k)), "gci": gci, "t_c_deg_per_Nm": t_c}

    result: dict[str, Any] = {
        "designs": len(found),
        "reading": found.reading,
        "seconds": seconds,
        "reach": int(found.values.reaches.sum()),
        "feasible": int(met.sum()),
        "best": {name: entry(k) for name, k in best(found, constraints).items()},
        "pareto_size": len(front),
        "pareto": [entry(int(k)) for k in front[:200]],
    }
    try:
        k = found.find(CHOSEN)
    except InfeasibleDesign:
        return result
    each = {name: bool(flags[k]) for name, flags in constraints.each(found.values).items()}
    rank, among = found.rank(k, found.values.reaches)
    better = len(found.dominating(k, found.values.reaches))
    result["chosen"] = {**entry(k), "meets": each, "rank": rank, "of": among, "dominated_by": better}
    return result


def text(result: dict[str, Any]) -> str:
    """Return such a result as lines of text."""
    lines = [
        f"{result['designs']} designs in {result['seconds']:.2f} s, reading {result['reading']}",
        f"  {result['reach']} reach, {result['feasible']} meet the constraints, {result['pareto_size']} on the front",
    ]
    for name, entry in result["best"].items():
        lines.append(f"  {name:30s} {_entry(entry)}")
    if "chosen" in result:
        chosen = result["chosen"]
        failed = [name for name, met in chosen["meets"].items() if not met]
        lines.append(f"  {'chosen by the paper':30s} {_entry(chosen)}")
        verdict = "violates " + ", ".join(failed) if failed else "meets the constraints"
        lines.append(
            f"  it {verdict}; rank {chosen['rank']} of {chosen['of']} by GCI / T_c among designs that reach, "
            f"{chosen['dominated_by']} are better in both"
        )
    return "\n".join(lines)


def _entry(entry: dict[str, Any]) -> str:
    return f"{entry['design']:34s} GCI {entry['gci']:.4f}  T_c {entry['t_c_deg_per_Nm']:.4f} deg/(N m)"
