"""The safety of the SHER 3.0, measured: every component is broken in turn while the robot runs.

A `Row` is a fault of a component, a `State` the motion in which it happens. The runs play rows in stepped time
(`run_matrix`), in wall time (`run_wall`) and nothing at all (`run_healthy`); a `Recording` gives the `Outcome` of each
fault, and `judge` its `Verdict`.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_safety.measurement.recording import Outcome as Outcome
    from sher3_safety.measurement.recording import Recording as Recording
    from sher3_safety.measurement.verdict import Verdict as Verdict
    from sher3_safety.measurement.verdict import judge as judge
    from sher3_safety.rows.row import STATES as STATES
    from sher3_safety.rows.row import Row as Row
    from sher3_safety.rows.row import State as State
    from sher3_safety.rows.row import select as select
    from sher3_safety.rows.stepped import ROWS as ROWS
    from sher3_safety.runs.healthy import run_healthy as run_healthy
    from sher3_safety.runs.matrix import MatrixResult as MatrixResult
    from sher3_safety.runs.matrix import run_matrix as run_matrix
    from sher3_safety.runs.wall import run_wall as run_wall

__getattr__, __dir__ = lazy(
    __name__,
    {
        "measurement.recording": ("Outcome", "Recording"),
        "measurement.verdict": ("Verdict", "judge"),
        "rows.row": ("Row", "STATES", "State", "select"),
        "rows.stepped": ("ROWS",),
        "runs.healthy": ("run_healthy",),
        "runs.matrix": ("MatrixResult", "run_matrix"),
        "runs.wall": ("run_wall",),
    },
)
