"""Foreign tools on the local link: the canopen library with its own threads, through the python-can bus."""

import threading

import canopen
import pytest
from sher3_description import load_robot
from sher3_drivers.bus.link import open_link
from sher3_drivers.bus.python_can import LinkBus
from sher3_drivers.canopen.dictionary import drive_dictionary
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.settings import default_settings


@pytest.fixture
def served(runtime_folder):
    """Mock drives served by a thread; yields the link of their first channel."""
    robot, settings, over = load_robot(), default_settings(), threading.Event()
    mock = MockDriveBus(
        [open_link(c.link) for c in settings.channels], IntegratorPlant(robot, settings.period), robot, settings
    )

    def serve():
        while not over.is_set():
            mock.serve(0.01)

    thread = threading.Thread(target=serve)
    thread.start()
    yield settings.channels[0].link
    over.set()
    thread.join()
    mock.close()


def test_the_canopen_library_configures_a_drive_over_the_local_link(served):
    with canopen.Network(LinkBus(served)) as network:
        network.connect()
        node = network.add_node(2, drive_dictionary())
        node.sdo.RESPONSE_TIMEOUT = 5.0
        assert node.sdo[0x1000].raw == 0x00020192
        node.sdo[0x6085].raw = 1234
        assert node.sdo[0x6085].raw == 1234
        with pytest.raises(canopen.SdoAbortedError):
            node.sdo[0x6041].raw = 1
        node.sdo[0x1017].raw = 10
        node.nmt.state = "OPERATIONAL"
        # One that was sent before the command may still be on its way to the library's thread.
        assert "OPERATIONAL" in (node.nmt.wait_for_heartbeat(5.0) for _ in range(100))
        assert network.scanner.nodes == [2]
