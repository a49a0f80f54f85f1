"""A CAN link that fails in one direction only stops the robot on the others: it may still look alive in the other."""

import itertools

import pytest
from sher3_common.reasons import Reason
from sher3_description import load_robot
from sher3_drivers.bus.condition import BusCondition
from sher3_drivers.bus.link import open_link
from sher3_drivers.errors import LinkError
from sher3_drivers.mock import drive as mock_drive
from sher3_drivers.mock.rig import LockstepRig
from sher3_drivers.settings import default_settings

_numbers = itertools.count()


@pytest.mark.parametrize("direction", ["recv_frames", "send_frames"])
def test_a_link_that_fails_in_one_direction_stops_the_drives_of_the_other(direction, monkeypatch):
    number = next(_numbers)
    rig = LockstepRig(load_robot(), default_settings(), lambda i: open_link(f"virtual:loss{number}-{i}"))
    rig.enable()
    rig.tick([0.001] * 5)
    link = rig.host_links[1]

    def fail(*_):
        raise LinkError("is broken", link=link.name)

    monkeypatch.setattr(link, direction, fail)
    rig.tick([0.001] * 5)
    rig.tick()
    assert rig.driver.stop.code is Reason.LINK_LOST and rig.driver.watches.bus.conditions[1] is BusCondition.OFF
    rig.tick()
    assert not rig.driver.enabled
    states = {rig.mock.drives[name].state for name in rig.settings.channels[0].drives}
    assert states == {mock_drive.QUICK_STOP}
    monkeypatch.undo()
    rig.close()
