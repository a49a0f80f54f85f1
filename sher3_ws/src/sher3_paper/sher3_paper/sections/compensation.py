"""How much of the tip's deflection the force-aware compensation takes away, in simulation."""

from __future__ import annotations

from sher3_paper.comparison import Section, computed
from sher3_paper.simulated import compensation

COMMAND = "sher3 paper --only compensation"
CASES = (("as modelled", 1.0, 1.0), ("20 % softer", 1.2, 1.2), ("20 % stiffer", 0.8, 0.8))


def deflection_compensation() -> Section:
    """Return the part on compensation; the paper proposes it and prints no result."""
    lines = []
    for name, links, structure in CASES:
        result = compensation(links, structure)
        before, after = (1e6 * float((values**2).mean() ** 0.5) for values in (result.before, result.after))
        lines.append(computed(f"tip error uncompensated, robot {name}", "um", before, COMMAND, "rms, 1 N hand force"))
        lines.append(
            computed(f"tip error compensated, robot {name}", "um", after, COMMAND, f"{result.left:.1%} is left")
        )
    text = (
        "The plant holds six random poses under 1 N of hand force in random directions; its links and structure "
        "give way as the model says, or 20 % more or less. The command is corrected by the modelled deflection of "
        "the wrench that the noisy force sensor reports."
    )
    return Section("compensation", "Force-aware deflection compensation", text, lines)
