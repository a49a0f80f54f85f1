"""The small real-time runtime under the nodes, and the one place beside them that sees rclpy.

A node needs five words: `on_tick` runs a function on the clock grid, `latest` gives the newest sample of a topic,
`subscribe` and `advertise` join a topic, `clock_of` tells the time. `Graph` runs nodes in stepped time for tests. The
clock, the codecs and the statistics are plain Python; importing this package alone loads no rclpy.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_runtime.clock import Clock as Clock
    from sher3_runtime.clock import SteppedClock as SteppedClock
    from sher3_runtime.execution.graph import Graph as Graph
    from sher3_runtime.execution.spinning import spin as spin
    from sher3_runtime.on_demand import advertise_on_demand as advertise_on_demand
    from sher3_runtime.ports import NODE_OPTIONS as NODE_OPTIONS
    from sher3_runtime.ports import advertise as advertise
    from sher3_runtime.ports import advertise_raw as advertise_raw
    from sher3_runtime.ports import clock_of as clock_of
    from sher3_runtime.ports import latest as latest
    from sher3_runtime.ports import on_readable as on_readable
    from sher3_runtime.ports import on_tick as on_tick
    from sher3_runtime.ports import statistics_of as statistics_of
    from sher3_runtime.ports import subscribe as subscribe
    from sher3_runtime.ports import subscribe_raw as subscribe_raw
    from sher3_runtime.ports import use_clock as use_clock

__getattr__, __dir__ = lazy(
    __name__,
    {
        "clock": ("Clock", "SteppedClock"),
        "execution.graph": ("Graph",),
        "on_demand": ("advertise_on_demand",),
        "ports": (
            "NODE_OPTIONS",
            "advertise",
            "advertise_raw",
            "clock_of",
            "latest",
            "on_readable",
            "on_tick",
            "statistics_of",
            "subscribe",
            "subscribe_raw",
            "use_clock",
        ),
        "execution.spinning": ("spin",),
    },
)
