"""Clock grid, executor, CDR codecs and process statistics.

`samples`, `cdr`, `clock` and `timing` are plain Python; `ports`, `spinning` and `graph` see rclpy. Import from here
what a node needs.
"""

from typing import TYPE_CHECKING

from .samples import DiagnosticSample as DiagnosticSample
from .samples import JointSample as JointSample
from .samples import JoySample as JoySample
from .samples import PoseSample as PoseSample
from .samples import Sample as Sample
from .samples import TemperatureSample as TemperatureSample
from .samples import TextSample as TextSample
from .samples import TwistSample as TwistSample
from .samples import WrenchSample as WrenchSample

if TYPE_CHECKING:
    from .clock import Clock as Clock
    from .clock import SteppedClock as SteppedClock
    from .graph import Graph as Graph
    from .on_demand import advertise_on_demand as advertise_on_demand
    from .ports import NODE_OPTIONS as NODE_OPTIONS
    from .ports import advertise as advertise
    from .ports import advertise_raw as advertise_raw
    from .ports import clock_of as clock_of
    from .ports import latest as latest
    from .ports import on_readable as on_readable
    from .ports import on_tick as on_tick
    from .ports import statistics_of as statistics_of
    from .ports import subscribe as subscribe
    from .ports import subscribe_raw as subscribe_raw
    from .ports import use_clock as use_clock
    from .spinning import spin as spin

_DOORS = {
    "NODE_OPTIONS": "ports",
    "advertise": "ports",
    "advertise_on_demand": "on_demand",
    "advertise_raw": "ports",
    "clock_of": "ports",
    "latest": "ports",
    "on_readable": "ports",
    "on_tick": "ports",
    "statistics_of": "ports",
    "subscribe": "ports",
    "subscribe_raw": "ports",
    "use_clock": "ports",
    "spin": "spinning",
    "Graph": "graph",
    "Clock": "clock",
    "SteppedClock": "clock",
}


def __getattr__(name: str) -> object:
    """Import a door at its first use, so that `import sher3_runtime` alone needs no rclpy."""
    if name in _DOORS:
        from importlib import import_module

        return getattr(import_module(f".{_DOORS[name]}", __name__), name)
    raise AttributeError(name)
