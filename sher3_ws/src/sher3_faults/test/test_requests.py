"""Requests for faults are checked at the door: what does not exist is refused by name."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_description import load_robot
from sher3_drivers.bus.frame import pack_frame
from sher3_drivers.bus.link import open_link
from sher3_drivers.canopen import objects as od
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.drive import AxisReading
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.pedal.device import PedalState
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.sensor.device import InProcessForceSensor
from sher3_drivers.settings import default_settings
from sher3_faults.errors import FaultRefused
from sher3_faults.injector import FaultInjector
from sher3_faults.requests import DEVICES, PLUGS, make_request, parse_request
from sher3_safety.rows.stepped import ROWS

ROBOT = load_robot()


class Devices:
    """The device ends of a plant process, and the time [ns] that their faults see."""

    def __init__(self, name: str) -> None:
        settings = default_settings()
        links = [open_link(f"virtual:{name}-{i}") for i in range(len(settings.channels))]
        self.drives = MockDriveBus(links, IntegratorPlant(ROBOT, settings.period), ROBOT, settings, lambda: 0)
        self.force, self.pedal = InProcessForceSensor(), InProcessPedal()
        self.now = 0


@pytest.fixture
def devices(request):
    return Devices(request.node.name)


@pytest.fixture
def injector(devices):
    return FaultInjector(devices.drives, devices.force, devices.pedal, lambda: devices.now)


@pytest.mark.parametrize(
    ("values", "part"),
    [
        ({"component": "sensor", "fault": "off"}, "no such component; value sensor; limit force_sensor, pedal"),
        ({"component": "force_senso", "fault": "off"}, "clock; did you mean force_sensor?"),
        ({"component": "pedal", "fault": "broken"}, "no such fault; value broken; limit off, stuck"),
        ({"component": "pedal", "fault": "stick"}, "ok; did you mean stuck?"),
        ({"component": "pedal", "fault": "slow", "parameters": {"delay": 1.0}}, "no such parameter; value delay"),
        (
            {"component": "pedal", "fault": "slow", "parameters": {"every": 1.0}},
            "every is out of range; value 1;",
        ),
        ({"component": "all", "fault": "off"}, "only ok goes with all"),
        ({"component": "wires", "fault": "off"}, "only plugs are miswired"),
        ({"component": "bus", "fault": "miswired"}, "only plugs are miswired"),
        ({"component": "pedal", "fault": "off", "duration": -1.0}, "duration: Input should be greater"),
        ({"component": "pedal", "fault": "off", "extra": 1}, "extra: Extra inputs"),
        ({"component": "bus2", "fault": "off"}, "no such channel; value bus2; limit bus0 to bus1"),
    ],
)
def test_what_does_not_exist_is_refused_by_name(injector, values, part):
    with pytest.raises(FaultRefused) as caught:
        injector.take(make_request(**values).to_json(), 0)
    assert part in str(caught.value)
    assert not injector.active


@given(st.text(max_size=200) | st.binary(max_size=50).map(lambda data: data.decode("latin-1")))
def test_any_text_is_a_request_or_refused(text):
    with pytest.raises(FaultRefused):
        parse_request(text)


def test_a_request_survives_its_text():
    request = make_request(component="roll.demand", fault="wrong", duration=0.5, seed=3, parameters={"scale": -1.0})
    assert parse_request(request.to_json()) == request


def test_every_row_of_the_matrix_is_a_valid_request():
    names = [row.name for row in ROWS]
    assert len(set(names)) == len(names)
    for row in ROWS:
        row.request(1, row.name)


def test_seams_are_closed_unless_a_fault_needs_them(devices, injector):
    drives, force, pedal = devices.drives, devices.force, devices.pedal
    names = ("tamper_frames", "tamper_received", "crossed")
    seams = lambda: (*(getattr(drives, name) for name in names), force.tamper, pedal.tamper)  # noqa: E731
    assert seams() == (None,) * 5
    for component in DEVICES:
        if not component.startswith(("bus2", "bus3", "bus4")):
            fault = "wrong" if component.endswith(".statusword") else "miswired" if component in PLUGS else "off"
            injector.take(make_request(component=component, fault=fault).to_json(), 0)
    assert all(seams())
    injector.take(make_request(component="all", fault="ok").to_json(), 0)
    injector.poll(0)
    assert seams() == (None,) * 5
    assert all(drive.tamper is None and drive.powered for drive in drives.drives.values())


def test_a_fault_begins_and_ends_at_its_time(devices, injector):
    request = make_request(component="pedal", fault="wrong", start=0.01, duration=0.02, parameters={"offset": 1.0})
    injector.take(request.to_json(), 0)
    travels = []
    for tick in range(20):
        devices.now = tick * 2_000_000
        injector.poll(devices.now)
        devices.pedal.put(PedalState(0.25, False))
        travels.append(devices.pedal.read().travel)
    assert travels == [0.25] * 5 + [1.25] * 10 + [0.25] * 5
    assert not injector.active


def test_an_unplugged_drive_is_silent_and_deaf_until_it_is_plugged_in(devices, injector):
    drive = devices.drives.drives["roll"]
    injector.take(make_request(component="roll", fault="off", duration=0.01).to_json(), 0)
    injector.poll(0)
    assert not drive.powered
    injector.poll(20_000_000)
    assert drive.powered


def test_a_group_breaks_its_axes_and_no_other(devices, injector):
    injector.take(make_request(component="legs.encoders", fault="wrong", parameters={"offset": 1e-3}).to_json(), 0)
    broken = {name for name, drive in devices.drives.drives.items() if drive.tamper is not None}
    assert broken == {"delta_1", "delta_2", "delta_3"}
    said = devices.drives.drives["delta_2"].tamper(AxisReading(0.01, 0.02, 0.0, 0.0))
    assert said[:2] == pytest.approx((0.011, 0.021))


def test_each_axis_of_a_group_has_a_fault_of_its_own(devices, injector):
    injector.take(make_request(component="axes.encoders", fault="stuck").to_json(), 0)
    for number, drive in enumerate(devices.drives.drives.values()):
        for count in range(3):
            said = drive.tamper(AxisReading(number + count, 10.0 + number + count, 0.0, 0.0))
        assert said[:2] == (number, 10.0 + number)


def test_a_demand_is_broken_in_its_own_unit(devices, injector):
    drive = devices.drives.drives["delta_1"]
    injector.take(make_request(component="delta_1.demand", fault="creep", parameters={"speed": 1e-5}).to_json(), 0)
    assert drive.mistake(0.0) * drive.scale.velocity == pytest.approx(1e-5)


def test_a_motor_that_is_turned_needs_no_power(devices, injector):
    drive = devices.drives.drives["roll"]
    for part, moves in (("power", 0.0), ("motor", 0.02)):
        injector.take(make_request(component=f"roll.{part}", fault="creep", parameters={"speed": 0.02}).to_json(), 0)
        assert drive.demand(0.002) == pytest.approx(moves)


def test_a_statusword_is_misstated_while_the_fault_lasts(devices, injector):
    drive = devices.drives.drives["tilt"]
    true = drive.statusword
    request = make_request(component="tilt.statusword", fault="wrong", duration=0.01, parameters={"code": 512.0})
    injector.take(request.to_json(), 0)
    injector.poll(0)
    assert drive.statusword == true ^ 0x200
    injector.poll(20_000_000)
    injector.poll(20_000_000)
    assert drive.statusword == true


@pytest.mark.parametrize(
    ("plug", "crossed"),
    [
        ("wires", {"command", "effort", "demand", "motor_position", "load_position"}),
        ("wires.load_encoders", {"load_position"}),
        ("wires.motors", {"command", "effort", "demand"}),
        ("wires.encoder_pairs", {"motor_position", "load_position"}),
    ],
)
def test_exchanged_plugs_take_what_goes_through_them(devices, injector, plug, crossed):
    injector.take(make_request(component=plug, fault="miswired").to_json(), 0)
    for column in ("command", "effort", "demand", "motor_position", "load_position"):
        through = devices.drives.crossed(column, (1.0, 2.0, 3.0, 4.0, 5.0))
        assert tuple(through[:3]) == ((2.0, 1.0, 3.0) if column in crossed else (1.0, 2.0, 3.0))


def test_a_lost_reset_leaves_all_other_frames_of_all_drives(devices, injector):
    first, second = (devices.drives.drives[name] for name in ("delta_1", "delta_2"))
    reset, other = bytes([0x80, 0, 0, 0, 0, 0]), bytes([0x0F, 0, 1, 2, 3, 4])
    frames = [pack_frame(od.RPDO_BASE + drive.node_id, data) for drive in (first, second) for data in (reset, other)]
    injector.take(make_request(component="delta_1.resets", fault="off").to_json(), 0)
    assert devices.drives.tamper_frames is None
    assert devices.drives.tamper_received(0, b"".join(frames), 0) == b"".join(frames[1:])
    with pytest.raises(FaultRefused, match="it comes or it does not"):
        make_request(component="delta_1.resets", fault="stuck")


def test_a_count_beyond_its_register_wraps_as_in_a_drive(devices, injector):
    injector.take(make_request(component="delta_1.encoders", fault="wrong", parameters={"offset": 1e3}).to_json(), 0)
    devices.drives.drives["delta_1"].sample(0.0, 0.0, 0.0, 0.0)
