"""Requests for faults are checked at the door: what does not exist is refused by name."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st
from sher3_description import load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.pedal.device import PedalState
from sher3_drivers.pedal.in_process import InProcessPedal
from sher3_drivers.sensor.device import InProcessForceSensor
from sher3_drivers.settings import default_settings
from sher3_faults.errors import FaultRefused
from sher3_faults.injector import FaultInjector
from sher3_faults.requests import DEVICES, make_request, parse_request
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
        ({"component": "pedal", "fault": "broken"}, "no such fault; value broken; limit off, stuck"),
        ({"component": "pedal", "fault": "slow", "parameters": {"delay": 1.0}}, "no such parameter; value delay"),
        (
            {"component": "pedal", "fault": "slow", "parameters": {"every": 1.0}},
            "every is out of range; value 1;",
        ),
        ({"component": "all", "fault": "off"}, "only ok goes with all"),
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
    seams = lambda: (drives.tamper_frames, drives.tamper_received, force.tamper, pedal.tamper)  # noqa: E731
    assert seams() == (None,) * 4
    for component in DEVICES:
        if not component.startswith(("bus2", "bus3", "bus4")):
            injector.take(make_request(component=component, fault="off").to_json(), 0)
    assert all(seams())
    injector.take(make_request(component="all", fault="ok").to_json(), 0)
    injector.poll(0)
    assert seams() == (None,) * 4
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
