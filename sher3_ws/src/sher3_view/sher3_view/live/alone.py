"""The live view as a process that another command starts: `python -m sher3_view.live.alone DOMAIN PORT`."""

from __future__ import annotations

import sys
from pathlib import Path


def show(robot: Path | None, port: int, domain: int, seconds: float | None) -> None:
    """Serve the live page of a domain's robot until a signal, or for so many seconds.

    Raises:
        ExtraMissing: viser is not installed.
    """
    from sher3_description import load_robot
    from sher3_effects import plants
    from sher3_kinematics import RobotKinematics

    from sher3_view.live.page import LivePage
    from sher3_view.live.view_node import run

    page = LivePage(RobotKinematics(load_robot(robot)), port, {name: kind.sites for name, kind in plants().items()})
    print(f"live on {page.url}", flush=True)
    run(page, domain, seconds)


if __name__ == "__main__":
    show(None, int(sys.argv[2]), int(sys.argv[1]), None)
