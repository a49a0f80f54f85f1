"""The challenge on a foreign engine: serial arms simulated by MuJoCo with faults of its own, diagnosed blind.

`truth/` knows the faults and imports nothing of the diagnosis; `answer/` sees records and a nominal model and cannot
look the truth up. `run_arms(seeds, robots, folder)` does both and scores.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_arms.errors import ArmsError as ArmsError
    from sher3_arms.run import run_arms as run_arms

__getattr__, __dir__ = lazy(__name__, {"errors": ("ArmsError",), "run": ("run_arms",)})
