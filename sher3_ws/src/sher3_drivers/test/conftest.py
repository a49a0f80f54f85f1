"""A parametrised fixture runs a test on every CAN back-end; socketcan is skipped, visibly, without kernel support."""

import itertools
import os

import pytest
from sher3_description import load_robot
from sher3_drivers.bus import open_link
from sher3_drivers.errors import LinkError
from sher3_drivers.lockstep_rig import LockstepRig
from sher3_drivers.settings import default_settings

ROBOT = load_robot()
_numbers = itertools.count()


@pytest.fixture(params=["virtual", "local", "socketcan"])
def open_pair(request, tmp_path, monkeypatch):
    """A function that opens one more participant of a fresh channel; all are closed at the end."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    channel = os.environ.get("SHER3_TEST_CAN", "vcan0") if request.param == "socketcan" else f"t{next(_numbers)}"
    links = []

    def open_one():
        try:
            links.append(open_link(f"{request.param}:{channel}"))
        except LinkError as error:
            if request.param == "socketcan":
                pytest.skip(f"no SocketCAN here: {error}")
            raise
        return links[-1]

    open_one.kind = request.param
    yield open_one
    for link in links:
        link.close()


@pytest.fixture(params=["virtual", "local", "cable"])
def make_rig(request, tmp_path, monkeypatch):
    """A function that builds a rig; the whole suite runs on links that need no hardware: channels one by one in the
    process or on sockets of their own, and together on one."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    rigs = []

    def make(**changes):
        name = f"d{next(_numbers)}"
        links = name if request.param == "cable" else lambda i: open_link(f"{request.param}:{name}-{i}")
        rigs.append(LockstepRig(ROBOT, default_settings().model_copy(update=changes), links))
        return rigs[-1]

    yield make
    for rig in rigs:
        rig.close()


@pytest.fixture
def rig(make_rig):
    """An enabled rig."""
    made = make_rig()
    made.enable()
    return made
