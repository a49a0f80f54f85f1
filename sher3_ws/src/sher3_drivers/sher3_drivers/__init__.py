"""CAN motor drivers, force sensor and pedal of the SHER 3.0, and mock devices that speak the same wire protocols.

The main object is the `MotorDriver`: once per control period it sends SYNC, collects what the five drives say, and
sends them a velocity command. It runs over any `CanLink`, so the same code drives the robot, mock drives in another
process, and both ends in stepped time (`LockstepRig`).
"""

from typing import TYPE_CHECKING

from sher3_common.faces import lazy

if TYPE_CHECKING:
    from sher3_drivers.bus.link import CanLink as CanLink
    from sher3_drivers.bus.link import open_links as open_links
    from sher3_drivers.drive.motor_driver import MotorDriver as MotorDriver
    from sher3_drivers.mock.bus import MockDriveBus as MockDriveBus
    from sher3_drivers.mock.rig import LockstepRig as LockstepRig
    from sher3_drivers.pedal.device import PedalState as PedalState
    from sher3_drivers.pedal.hid import HidPedal as HidPedal
    from sher3_drivers.sensor.device import WrenchRecord as WrenchRecord
    from sher3_drivers.sensor.netft import NetFtSensor as NetFtSensor
    from sher3_drivers.settings import MotorDriverSettings as MotorDriverSettings
    from sher3_drivers.settings import default_settings as default_settings

__getattr__, __dir__ = lazy(
    __name__,
    {
        "bus.link": ("CanLink", "open_links"),
        "drive.motor_driver": ("MotorDriver",),
        "mock.bus": ("MockDriveBus",),
        "mock.rig": ("LockstepRig",),
        "pedal.device": ("PedalState",),
        "pedal.hid": ("HidPedal",),
        "sensor.device": ("WrenchRecord",),
        "sensor.netft": ("NetFtSensor",),
        "settings": ("MotorDriverSettings", "default_settings"),
    },
)
