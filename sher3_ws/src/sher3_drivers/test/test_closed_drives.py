"""Drives are closed: what shapes motion is written and read back; name plates, optional objects, unwilling drives."""

import pytest
from sher3_common.reasons import Action, Reason
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.canopen import objects as od
from sher3_drivers.canopen.configuration import MOCK_IDENTITY, holds, required_values, required_writes
from sher3_drivers.canopen.objects import OBJECTS, Address
from sher3_drivers.errors import DriveMismatch, DriverSettingsError, DriveSilent
from sher3_drivers.settings import DriveIdentity, MotorDriverSettings, default_settings
from sher3_drivers.units import AxisScale

ROBOT = load_robot()
SCALE = AxisScale.from_actuator(ROBOT.actuators[0])
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
pytestmark = pytest.mark.parametrize("make_rig", ["cable"], indirect=True)
SHAPES_MOTION = [
    od.POLARITY, Address(0x607C, 0), Address(0x60B0, 0), Address(0x60B1, 0), Address(0x60B2, 0), Address(0x605A, 0),
    Address(0x605B, 0), Address(0x605C, 0), Address(0x605D, 0), Address(0x605E, 0), od.ABORT_CONNECTION,
    Address(0x6065, 0), Address(0x6066, 0), od.LOWER_LIMIT, od.UPPER_LIMIT, od.MAX_TORQUE, Address(0x60E0, 0),
    Address(0x60E1, 0), od.SYNC_COUNTER, Address(0x1400, 2), od.RPDO_TIMEOUT, od.MAX_MOTOR_SPEED, Address(0x607F, 0),
    Address(0x6083, 0), Address(0x6084, 0), od.QUICK_STOP_DECELERATION, Address(0x6086, 0), Address(0x60C5, 0),
    Address(0x60C6, 0), Address(0x60A8, 0), od.VELOCITY_UNIT, Address(0x60AA, 0),
]  # fmt: skip


def test_the_limits_of_a_leg_are_those_of_the_robot_file(make_rig):
    """By hand: 38 mm and 5 % of 76 mm at 1 um; 200 N of 80 N; 12.2 mm/s on 2 mm a revolution; 0.5 mm."""
    values = required_values(1, SCALE, default_settings())
    assert (values[od.LOWER_LIMIT], values[od.UPPER_LIMIT]) == (-41800, 41800)
    assert values[od.MAX_TORQUE] == 2500 and values[od.MAX_MOTOR_SPEED] == 366
    assert values[Address(0x6065, 0)] == 500 and values[od.RPDO_TIMEOUT] == 27
    assert values[Address(0x6084, 0)] == values[od.QUICK_STOP_DECELERATION] == 54900


@pytest.mark.parametrize("address", SHAPES_MOTION, ids=str)
def test_what_shapes_motion_is_written_and_read_back(make_rig, address):
    rig = make_rig()
    drive = rig.mock.drives["tilt"]
    assert address in dict(required_writes(5, rig.driver.scales[4], rig.settings))
    kept = dict(drive.node.values)

    class Stubborn(dict):
        def __setitem__(self, key, value):
            super().__setitem__(key, kept[key] ^ 64 if key == address else value)

    drive.node.values = Stubborn(kept)
    with pytest.raises(DriveMismatch, match=str(address)):
        rig.driver.configure()
    assert not any(drive.node.operational for drive in rig.mock.drives.values())


@pytest.mark.parametrize("address", [a for a in SHAPES_MOTION if OBJECTS[a].optional], ids=str)
def test_an_optional_object_may_be_missing_and_is_named(make_rig, address):
    rig = make_rig()
    rig.mock.drives["roll"].node.missing = frozenset({address})
    rig.enable()
    assert rig.driver.absent["roll"] == (str(address),) and rig.driver.absent["tilt"] == ()


@pytest.mark.parametrize(
    "address", [Address(0x608F, 1), *[a for a in SHAPES_MOTION if not OBJECTS[a].optional]], ids=str
)
def test_an_object_that_every_drive_has_must_not_be_missing(make_rig, address):
    rig = make_rig()
    rig.mock.drives["roll"].node.missing = frozenset({address})
    with pytest.raises(DriveSilent, match="roll"):
        rig.driver.configure()


def test_a_larger_number_of_entries_is_accepted_and_a_smaller_one_is_not(make_rig):
    entries, plain = Address(0x1018, 0), od.MAX_TORQUE
    assert holds(entries, 4, 1) and not holds(entries, 0, 1)
    assert holds(plain, 7, 7) and not holds(plain, 8, 7)


def plates(**changes):
    identities = [MOCK_IDENTITY.model_copy(update={"drive": n, "serial": i}) for i, n in enumerate(ACTUATORS, 1)]
    return tuple([identities[0].model_copy(update=changes), *identities[1:]])


def test_drives_with_the_configured_name_plates_are_accepted(make_rig):
    make_rig(identities=plates()).enable()


@pytest.mark.parametrize("part", ["vendor", "product", "serial"])
def test_a_drive_with_another_name_plate_is_refused(make_rig, part):
    with pytest.raises(DriveMismatch, match="0x1018"):
        make_rig(identities=plates(**{part: 77})).driver.configure()


@pytest.mark.parametrize("names", [["elbow"], ["roll", "roll"]])
def test_name_plates_of_no_drive_or_of_one_twice_are_refused(make_rig, names):
    values = default_settings().model_dump()
    values["identities"] = [DriveIdentity(drive=name, vendor=1, product=1, serial=1) for name in names]
    with pytest.raises(DriverSettingsError, match="identities"):
        MotorDriverSettings.checked(**values)


# Drives that are enabled and say that they do not do as they are told.


@pytest.mark.parametrize(
    ("wrong", "text"), [(0x0200, "bit 9"), (0x0010, "bit 4"), (0x0800, "bit 11"), (0x1000, "bit 12")]
)
def test_a_drive_that_says_it_does_not_obey_stops_the_robot(rig, wrong, text):
    rig.tick(SLOW)
    kind = type(rig.mock.drives["delta_2"])
    word = kind.statusword.fget
    rig.mock.drives["delta_2"].__class__ = type(
        "Unwilling", (kind,), {"statusword": property(lambda drive: word(drive) ^ wrong)}
    )
    for _ in range(rig.settings.status_reports - 1):
        rig.tick(SLOW)
        assert rig.driver.stop.first is None
    rig.tick(SLOW)
    assert rig.driver.stop.code is Reason.DRIVE_UNWILLING and text in rig.driver.stop.reason


def test_a_warning_is_reported_and_stops_nothing(rig):
    kind = type(rig.mock.drives["delta_2"])
    word = kind.statusword.fget
    rig.mock.drives["delta_2"].__class__ = type("Warm", (kind,), {"statusword": property(lambda d: word(d) | 0x80)})
    for _ in range(10):
        rig.tick(SLOW)
    assert rig.driver.stop.first is None
    assert [drive.warns for drive in rig.driver.session.drives] == [False, True, False, False, False]


# Safe torque off: an input of the drives.


def test_safe_torque_off_stops_the_robot_with_its_own_reason(rig):
    rig.tick(SLOW)
    rig.mock.safe_torque_off(True)
    rig.tick(SLOW)
    rig.tick(SLOW)
    assert rig.driver.stop.code is Reason.SAFE_TORQUE_OFF and rig.driver.stop.action is Action.POWER_OFF
    assert rig.tick().velocity_demand == (0.0,) * 5


def test_a_recovery_while_the_torque_is_off_stops_again_and_succeeds_afterwards(rig):
    rig.mock.safe_torque_off(True)
    for _ in range(100):
        rig.tick()
    rig.driver.reset()
    for _ in range(100):
        rig.tick()
    assert rig.driver.stop.code is Reason.SAFE_TORQUE_OFF
    rig.mock.safe_torque_off(False)
    rig.driver.reset()
    for _ in range(10):
        rig.tick()
    assert rig.driver.stop.first is None
    rig.enable()
    rig.tick(SLOW)
    assert rig.tick(SLOW).velocity_demand[0] == pytest.approx(SLOW[0], abs=1e-9)
