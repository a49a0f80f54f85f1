"""Mock drives whose process was held up: time says how many steps the plant makes, the newest SYNC gets the answer."""

from __future__ import annotations

from sher3_description import load_robot
from sher3_drivers.mock.rig import LockstepRig
from sher3_drivers.settings import default_settings

ROBOT = load_robot()
SLOW = (1e-3, 0.0, 0.0, 0.0, 0.0)


HELD = 4
"""Ticks for which the process is held up."""


def test_drives_that_were_held_up_make_each_step_once_and_answer_the_newest_sync(runtime_folder):
    """They are served in the next tick, before its SYNC: hence one step more than there were ticks."""
    rig = LockstepRig(ROBOT, default_settings(ROBOT.control_period), "held")
    rig.enable()
    for _ in range(5):
        rig.tick(SLOW)
    mock, serves = rig.mock, rig.host_links[0].cable.other_side
    before, waits = mock.ticks + mock.free_steps, list(serves)
    serves.clear()
    for _ in range(HELD):
        assert rig.tick() is None
    serves.extend(waits)
    assert rig.tick() is not None
    assert mock.ticks + mock.free_steps - before == HELD + 2
    rig.close()
