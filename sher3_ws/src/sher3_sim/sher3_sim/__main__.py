"""`python -m sher3_sim [--json]`: the effects with their stages, places and parameters."""

from __future__ import annotations

import argparse
import json
from typing import Any

from sher3_sim.effects import EFFECTS, FAMILIES


def table() -> list[dict[str, Any]]:
    """Return one plain entry per effect, in the order of the contract's families."""
    order = [module.__name__.rpartition(".")[2] for module in FAMILIES]
    entries = []
    for kind in sorted(EFFECTS.values(), key=lambda kind: order.index(kind.family)):
        names = kind.specification(kind.places[0])
        entries.append(
            {
                "effect": kind.id,
                "family": kind.family,
                "stage": kind.stage,
                "actuators": kind.places,
                "explanation": " ".join((kind.__doc__ or "").split()),
                "parameters": {name: spec._asdict() for name, spec in names.items()},
            }
        )
    return entries


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m sher3_sim", description=__doc__)
    parser.add_argument("--json", action="store_true")
    if parser.parse_args().json:
        print(json.dumps(table(), indent=1))
        return
    for entry in table():
        print(f"\n{entry['effect']}  ({entry['family']}, {entry['stage']}; {' '.join(entry['actuators'])})")
        print(f"  {entry['explanation']}")
        for name, p in entry["parameters"].items():
            print(f"    {name:18} {p['default']:<10g} {p['low']:g} ... {p['high']:g} {p['unit']:6} {p['text']}")


if __name__ == "__main__":
    main()
