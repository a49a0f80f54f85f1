"""A run of the SHER 3.0: its settings, the processes with their nodes, and the surgeon who acts on mocks.

`checked` turns options into `RunSettings`; `run_graph` starts a `Fleet` of processes from them and ends it.
`SteppedRobot` is the same robot in one process and in stepped time. A `Script` tells what the surgeon does.
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_bringup.demo.session import run_demo as run_demo
    from sher3_bringup.errors import ConfigurationError as ConfigurationError
    from sher3_bringup.processes.fleet import Fleet as Fleet
    from sher3_bringup.processes.up import run_graph as run_graph
    from sher3_bringup.settings.patience import Patience as Patience
    from sher3_bringup.settings.patience import drives_in as drives_in
    from sher3_bringup.settings.run_settings import RunSettings as RunSettings
    from sher3_bringup.settings.run_settings import checked as checked
    from sher3_bringup.settings.run_settings import parse_processes as parse_processes
    from sher3_bringup.stepped_robot import SteppedRobot as SteppedRobot
    from sher3_bringup.surgeon.script import Script as Script
    from sher3_bringup.surgeon.script import demo_script as demo_script
    from sher3_bringup.surgeon.script import load_script as load_script

__getattr__, __dir__ = lazy(
    __name__,
    {
        "demo.session": ("run_demo",),
        "errors": ("ConfigurationError",),
        "processes.fleet": ("Fleet",),
        "processes.up": ("run_graph",),
        "settings.patience": ("Patience", "drives_in"),
        "settings.run_settings": ("RunSettings", "checked", "parse_processes"),
        "stepped_robot": ("SteppedRobot",),
        "surgeon.script": ("Script", "demo_script", "load_script"),
    },
)
