"""The nominal robot's file as a page: every parameter with its value, unit and source."""

from __future__ import annotations

from importlib.resources import files

INTRODUCTION = """# Parameters of the robot: robot.yaml

The nominal robot, as `load_robot()` reads it. The comment beside a number says what it is and where it comes from.
[The robot file](../robot.md) tells how it is read and checked.

"""


def page() -> str:
    """Return the page."""
    return f"{INTRODUCTION}```yaml\n{files('sher3_description').joinpath('robot.yaml').read_text()}```\n"
