"""The paper's bench-top tests (section V): commanded through the running graph, seen by two cameras, evaluated.

A test is a `Timeline`, made and checked by `planned` from a `Plan`; `run_tests` records it on the graph and returns the
pictures, `evaluate` the figures. `bench_robot` is the robot as it stands on the bench.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_benchtop.errors import BenchtopStopped as BenchtopStopped
    from sher3_benchtop.evaluation.evaluate import evaluate as evaluate
    from sher3_benchtop.fixture import bench_robot as bench_robot
    from sher3_benchtop.graph.runs import run_tests as run_tests
    from sher3_benchtop.graph.runs import run_timeline as run_timeline
    from sher3_benchtop.protocol.plan import TESTS as TESTS
    from sher3_benchtop.protocol.plan import Plan as Plan
    from sher3_benchtop.protocol.plan import planned as planned
    from sher3_benchtop.protocol.timeline import Builder as Builder
    from sher3_benchtop.protocol.timeline import Timeline as Timeline

__getattr__, __dir__ = lazy(
    __name__,
    {
        "errors": ("BenchtopStopped",),
        "evaluation.evaluate": ("evaluate",),
        "fixture": ("bench_robot",),
        "graph.runs": ("run_tests", "run_timeline"),
        "protocol.plan": ("Plan", "TESTS", "planned"),
        "protocol.timeline": ("Builder", "Timeline"),
    },
)
