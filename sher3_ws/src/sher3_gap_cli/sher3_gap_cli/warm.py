"""Compile the laws of the diagnosis before they are asked for: a simulated case is diagnosed and thrown away.

`make setup` runs it, `python -m sher3_gap_cli.warm` does after any other installation. The machine code stays in the
user's cache; without this the first diagnosis compiles it.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

EFFECTS = [{"effect": "backlash", "actuator": "tilt", "parameters": {"width": 60e-6}}]
"""Lost motion, since its laws are compiled and so are those of its rivals."""
EXCITATIONS = ("sweep", "reversals")


def warm_up() -> str:
    """Diagnose a simulated robot with a fault; return the status, which depends on nothing but the sources."""
    import numpy as np
    from sher3_bags import write_case
    from sher3_description import load_robot
    from sher3_diagnosis.judge.evidence.free_law import loss_left
    from sher3_effects.effects_file import effects_from_text
    from sher3_gap import diagnose_case
    from sher3_gap.excitation import excite
    from sher3_gap.experiments.rehearsal import rehearse

    # The case leaves nothing that free laws would be asked of.
    ramp = np.arange(180.0)[:, None]
    loss_left([ramp], ramp, np.arange(len(ramp)) % 3)
    robot = load_robot()
    wanted = [(excite(label, robot), repeat) for label in EXCITATIONS for repeat in range(2)]
    runs = rehearse(robot, wanted, effects_from_text(json.dumps(EFFECTS)))
    with TemporaryDirectory() as folder:
        case = Path(folder, "case")
        write_case(case, runs, robot)
        return str(diagnose_case(case).verdict.status)


def main() -> None:
    """Fill the cache of compiled code; end with a sentence where the readers of recordings are not installed."""
    try:
        warm_up()
    except ModuleNotFoundError as error:
        sys.exit(f"sher3: the laws of this robot need its recordings; no {error.name}; pip install 'sher3[bags]'")


if __name__ == "__main__":
    main()
