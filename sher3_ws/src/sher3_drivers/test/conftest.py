"""A parametrised fixture runs a test on every CAN back-end; socketcan is skipped, visibly, without kernel support.

Helpers beside the tests are importable.
"""

import itertools
import os
import sys
import tempfile
from pathlib import Path

import pytest
from sher3_description import load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.canopen.master import CanopenMaster
from sher3_drivers.errors import LinkError
from sher3_drivers.mock.rig import LockstepRig
from sher3_drivers.settings import default_settings

sys.path.insert(0, str(Path(__file__).parent))
ROBOT = load_robot()
_numbers = itertools.count()
INTERFACES = os.environ.get("SHER3_TEST_CAN", "vcan0,vcan1").split(",")
"""CAN interfaces of the tests, one per channel; a rig needs two."""


def open_interface(number):
    """Open the CAN interface of a channel, or skip."""
    if number >= len(INTERFACES):
        pytest.skip(f"SHER3_TEST_CAN names {len(INTERFACES)} CAN interfaces, {number + 1} are needed")
    try:
        return open_link(f"socketcan:{INTERFACES[number]}")
    except LinkError as error:
        pytest.skip(f"no SocketCAN here: {error}")


@pytest.fixture
def runtime_folder(monkeypatch):
    """A private folder for the sockets of a test, on a short path: that of a socket has 107 letters at most."""
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        yield Path(folder)


@pytest.fixture(params=["virtual", "local", "socketcan"])
def open_pair(request, runtime_folder):
    """A function that opens one more participant of a fresh channel; all are closed at the end."""
    channel, links = f"t{next(_numbers)}", []

    def open_one():
        socketcan = request.param == "socketcan"
        links.append(open_interface(0) if socketcan else open_link(f"{request.param}:{channel}"))
        return links[-1]

    yield open_one
    for link in links:
        link.close()


def pytest_collection_modifyitems(config, items):
    """Where a rig has no CAN interfaces, keep one test of each module, which says so when it skips."""
    missing = [name for name in INTERFACES[:2] if not Path("/sys/class/net", name).exists()]
    if not missing and len(INTERFACES) > 1:
        return
    said, kept, dropped = set(), [], []
    for item in items:
        rig_kind = item.callspec.params.get("make_rig") if hasattr(item, "callspec") else None
        (dropped if rig_kind == "socketcan" and item.path in said else kept).append(item)
        if rig_kind == "socketcan":
            said.add(item.path)
    items[:] = kept
    config.hook.pytest_deselected(items=dropped)


@pytest.fixture(params=["virtual", "local", "cable", "socketcan"])
def make_rig(request, runtime_folder):
    """A function that builds a rig; the whole suite runs on every back-end: channels one by one in the process or on
    sockets of their own, together on one socket, and on CAN interfaces where there are two."""
    rigs = []

    def make(**changes):
        name = f"d{next(_numbers)}"
        links = {"cable": name, "socketcan": open_interface}.get(
            request.param, lambda i: open_link(f"{request.param}:{name}-{i}")
        )
        rigs.append(LockstepRig(ROBOT, default_settings().model_copy(update=changes), links))
        return rigs[-1]

    yield make
    for rig in rigs:
        rig.close()


@pytest.fixture
def rig(make_rig, monkeypatch):
    """An enabled rig, its configuration written into the drives' dictionaries.

    Transfers of a thousand objects take 60 ms, ten times what most tests do. Whoever tests them makes a rig.
    """
    made = make_rig()
    node = {name: drive.node for name, drive in made.mock.drives.items()}
    with monkeypatch.context() as directly:
        directly.setattr(CanopenMaster, "write", lambda _, name, address, value: node[name].write(address, value))
        directly.setattr(CanopenMaster, "read", lambda _, name, address: node[name].values[address])
        made.enable()
    return made
