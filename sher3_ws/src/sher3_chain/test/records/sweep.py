"""Takes clean records through every nuisance and prints the share of unchanged verdicts and every miss by name.

`PYTHONPATH=sher3_ws/src/sher3_chain/test python sher3_ws/src/sher3_chain/test/records/sweep.py [RECORD ...]`;
without names all of them, measured ones too where their folder is at hand.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from functools import partial

from answers import answer
from clean_records import RECORDS
from measured_records import MEASURED, REAL
from metamorphic import Outcome, outcomes, table


def swept(name: str) -> list[Outcome]:
    """Return the outcomes of all nuisances on one record."""
    described, record = ({**RECORDS, **MEASURED})[name]()
    return list(outcomes(record, partial(answer, described)))


def main(names: Sequence[str]) -> None:
    """Print a table for each record, and the share of all."""
    found: list[Outcome] = []
    for name in names or [*RECORDS, *(MEASURED if REAL.is_dir() else ())]:
        started = time.perf_counter()
        own = swept(name)
        found += own
        print(f"{name}: {table(own)}\n  in {time.perf_counter() - started:.0f} s", flush=True)
    changed = sum(bool(x.difference) for x in found)
    print(f"all: {len(found)} verdicts, {1.0 - changed / len(found):.1%} unchanged, {changed} changed")


if __name__ == "__main__":
    main(sys.argv[1:])
