"""The caps of a speed regime in the driver's gate and in the drives (object 0x6080), changed while the robot runs."""

import json

import pytest
from sher3_common.reasons import Reason
from sher3_drivers.canopen import objects as od
from sher3_drivers.errors import CommandRefused
from sher3_drivers.settings import RegimeCaps

NEAR = (2.5e-3, 2.5e-3, 2.5e-3, 0.03, 0.9e-3)
FREE = (12.2e-3, 12.2e-3, 12.2e-3, 0.3, 9e-3)
NEAR_RPM, FREE_RPM = [75, 75, 75, 29, 27], [366, 366, 366, 287, 270]
"""By hand: 2.5 mm/s on a lead of 2 mm is 75 rpm, 0.9 mm/s 27 rpm; 0.03 rad/s at the roll is 28.6 rpm."""
CAPS = (RegimeCaps(regime="near_tissue", caps=NEAR), RegimeCaps(regime="free", caps=FREE))
SLOW = [0.001, -0.002, 0.002, 0.02, -0.0005]
FAST = [0.01, -0.01, 0.01, 0.2, -0.005]
pytestmark = pytest.mark.parametrize("make_rig", ["cable"], indirect=True)


def of_drives(rig):
    return [drive.node.values[od.MAX_MOTOR_SPEED] for drive in rig.mock.drives.values()]


def regime_rig(make_rig, regime):
    rig = make_rig(caps=CAPS, regime=regime)
    rig.enable()
    rig.tick([0.0] * 5)
    return rig


def announce(rig, **data):
    rig.driver.hear_regime(json.dumps(data))


@pytest.mark.parametrize(("regime", "rpm"), [("near_tissue", NEAR_RPM), ("free", FREE_RPM)])
def test_drives_start_with_the_caps_of_the_regime(make_rig, regime, rpm):
    assert of_drives(regime_rig(make_rig, regime)) == rpm


def test_a_command_above_the_cap_does_not_pass_the_gate(make_rig):
    rig = regime_rig(make_rig, "near_tissue")
    rig.tick(SLOW)
    with pytest.raises(CommandRefused, match="delta_1"):
        rig.tick(FAST)


def test_a_faster_regime_begins_when_every_drive_has_it(make_rig):
    rig = regime_rig(make_rig, "near_tissue")
    announce(rig, regime="near_tissue", coming="free")
    raised = None
    for k in range(25):
        if of_drives(rig) != FREE_RPM:
            assert rig.driver.gate.caps == NEAR
        elif raised is None and rig.driver.gate.caps == FREE:
            raised = k
        rig.tick(SLOW)
    assert raised is not None and raised * rig.settings.period <= 0.02, "well within the 50 ms of the announcement"
    rig.tick(FAST)
    assert rig.tick(FAST).velocity_demand[0] == pytest.approx(0.01, abs=1e-9)
    assert rig.driver.stop.first is None


def test_a_slower_regime_leaves_commands_the_time_to_become_slower(make_rig):
    rig = regime_rig(make_rig, "free")
    rig.tick(FAST)
    announce(rig, regime="near_tissue")
    for _ in range(40):
        rig.tick(FAST)
    for _ in range(30):
        rig.tick(SLOW)
    assert of_drives(rig) == NEAR_RPM and rig.driver.gate.caps == NEAR and rig.driver.stop.first is None


@pytest.mark.parametrize("text", ["", "7", "{", '{"regime": 5}', '{"regime": "bench"}', '{"coming": "warp"}'])
def test_what_names_no_regime_changes_nothing(make_rig, text):
    rig = regime_rig(make_rig, "near_tissue")
    rig.driver.hear_regime(text)
    for _ in range(60):
        rig.tick(SLOW)
    assert of_drives(rig) == NEAR_RPM and rig.driver.gate.caps == NEAR


def test_a_drive_that_does_not_keep_its_cap_stops_the_robot_and_is_asked_again(make_rig):
    rig = regime_rig(make_rig, "free")
    drive = rig.mock.drives["roll"]
    kept = drive.node.values

    class Stubborn(dict):
        def __setitem__(self, key, value):
            super().__setitem__(key, 287 if key == od.MAX_MOTOR_SPEED else value)

    drive.node.values = Stubborn(kept)
    announce(rig, regime="near_tissue")
    for _ in range(80):
        rig.tick(SLOW)
    assert rig.driver.stop.code is Reason.DRIVE_UNLIMITED and "roll: has 287 rpm" in rig.driver.stop.reason
    assert rig.driver.gate.caps == NEAR
    drive.node.values = dict(drive.node.values)
    rig.driver.reset()
    for _ in range(80):
        rig.tick()
    assert of_drives(rig) == NEAR_RPM and rig.driver.stop.first is None


def test_a_drive_that_does_not_answer_stops_the_robot(make_rig):
    rig = regime_rig(make_rig, "near_tissue")
    handle = rig.mock.drives["tilt"].node.handle
    rig.mock.drives["tilt"].node.handle = lambda can_id, data: None if can_id == 0x605 else handle(can_id, data)
    announce(rig, regime="near_tissue", coming="free")
    for _ in range(160):
        rig.tick(SLOW)
    assert rig.driver.stop.code is Reason.DRIVE_UNLIMITED and "tilt" in rig.driver.stop.reason
    assert rig.driver.gate.caps == NEAR


def test_a_drive_that_runs_away_is_no_faster_than_its_regime(make_rig):
    """A target of 10 mm/s that arrives whole at the drive: it executes 2.5 mm/s and says that it is at its limit."""
    rig = regime_rig(make_rig, "near_tissue")
    scale = rig.driver.scales[0]
    rig.mock.drives["delta_1"].mistake = lambda counts: 0.01 / scale.velocity
    feedback = [rig.tick(SLOW) for _ in range(3)][-1]
    assert feedback.velocity_demand[0] <= 2.5e-3 * (1 + 1e-9)
    assert rig.driver.stop.code is Reason.DRIVE_DISOBEYS
