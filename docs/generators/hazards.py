"""The hazard table as a page, from `sher3 safety hazards --json`."""

from __future__ import annotations

from generators.command_line import run_json
from generators.table import table

INTRODUCTION = """# Hazards

In the manner of ISO 14971 and IEC 62304: what may happen to the tip, why, what keeps it short, what verifies that, and
how far the tip may still travel. Written from the rows of the matrix and the travel budget (`sher3 safety hazards`): a
row that belongs to no hazard fails a test, and so does a hazard that nothing verifies. The residual is computed for
strict limits at 500 Hz; `--report bags/safety/report.json` adds what a run of the matrix measured.

Where no travel is computed, nothing here bounds it, and the last column says why. The residual of a force that is
false is that of the smallest one that is noticed.

This is no risk management file. Severity and probability of harm belong to a use that this project does not know, and
what stands under *what software alone cannot hold* needs hardware: an emergency stop circuit that takes the torque, a
second sensor at the handle, drives with CANopen Safety.

"""


def page() -> str:
    """Return the page."""
    rows = [_row(hazard) for hazard in run_json("safety", "hazards", "--json")["hazards"]]
    heads = (
        "hazard",
        "cause",
        "control",
        "verified by",
        "residual near / free [um]",
        "what software alone cannot hold",
    )
    return INTRODUCTION + table(heads, rows)


def _row(hazard: dict) -> tuple[str, ...]:
    lines = f"{hazard['rows']} rows of the matrix" if hazard["rows"] else ""
    tests = ", ".join(f"`{test.rsplit('/', 1)[-1]}`" for test in hazard["tests"])
    left = hazard["residual"]
    travel = f"{left['near_tissue']:.0f} / {left['free']:.0f}" if left else "not computed"
    verified = "; ".join(part for part in (lines, tests) if part)
    return hazard["hazard"], hazard["cause"], hazard["control"], verified, travel, hazard["gap"]
