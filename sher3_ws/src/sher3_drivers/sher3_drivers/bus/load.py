"""The bus-load budget: how many drives may share a channel at which cycle rate; checked before anything is sent.

Classic CAN with 11-bit identifiers: a frame of n data bytes is 47 + 8 n bits with the inter-frame space, and bit
stuffing adds at most (34 + 8 n - 1) // 4 bits (Davis, Burns, Bril, Lukkien 2007, "Controller Area Network (CAN)
schedulability analysis: refuted, revisited and revised", eq. 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from sher3_drivers.errors import BusLoadError

BIT_RATE = 1_000_000
"""Bit rate of the drives' channels, bit/s: the highest of classic CAN."""
RPDO_BYTES = 6
"""Controlword and target velocity (`canopen.objects.RPDO1`)."""
TPDO_BYTES = (8, 8)
"""The two TPDOs of a drive (`canopen.objects.TPDO1`, `TPDO2`)."""
CHECK_BYTES = 2
"""What protection adds to a command, and the third TPDO of a protected drive (`canopen.objects.TPDO3`)."""
LOAD_LIMIT = 0.90
"""Share of the bus for cyclic traffic and heartbeats in the worst case; the rest is for SDO, EMCY and repeats."""


def frame_bits(data_bytes: int, stuffed: bool = True) -> int:
    """Return the bits of one classic frame on the wire with its inter-frame space, with the most stuff bits or none."""
    return 47 + 8 * data_bytes + ((34 + 8 * data_bytes - 1) // 4 if stuffed else 0)


def fd_frame_seconds(data_bytes: int, arbitration_rate: float = 1e6, data_rate: float = 5e6) -> float:
    """Return the worst-case time of one CAN FD frame with its inter-frame space, s; only for comparison.

    ISO 11898-1:2015, base format with bit-rate switch: 17 bits before the switch and 13 after the CRC at the nominal
    rate, one stuff bit per four; ESI, DLC, data, stuff count and CRC (17 bits to 16 bytes, else 21) at the data rate.
    """
    crc, fixed_stuff = (17, 6) if data_bytes <= 16 else (21, 7)
    slow = 17 + (17 - 1) // 4 + 13
    fast = 5 + 8 * data_bytes + (5 + 8 * data_bytes - 1) // 4 + 4 + crc + fixed_stuff
    return slow / arbitration_rate + fast / data_rate


@dataclass(frozen=True)
class ChannelBudget:
    """What one channel carries.

    Attributes:
        drives: number of drives on the channel.
        rate: SYNC rate [Hz].
        load: worst-case share of the bus, heartbeats included.
        load_unstuffed: the same share without any stuff bits, the least it can be.
        feedback: seconds from SYNC to the last TPDO1 (position, status, torque), worst case.
        slack: seconds of a cycle that the control loop may take: from the last TPDO1 until the RPDOs must go out to
            arrive before the next SYNC. One frame of lower priority that blocks the wire meanwhile is allowed for.
    """

    drives: int
    rate: float
    load: float
    load_unstuffed: float
    feedback: float
    slack: float

    def __str__(self) -> str:
        return (
            f"{self.drives} drives at {self.rate:g} Hz: load {100 * self.load:.1f} % worst case "
            f"({100 * self.load_unstuffed:.1f} % unstuffed), "
            f"feedback after {1e6 * self.feedback:.0f} us, "
            f"{1e6 * self.slack:.0f} us left for the control loop"
        )


def channel_budget(
    drives: int, rate: float, heartbeat_rate: float = 0.0, bit_rate: int = BIT_RATE, protected: bool = False
) -> ChannelBudget:
    """Return the budget of one channel: SYNC, and per drive one RPDO and two TPDOs a cycle; heartbeats beside them.

    Protection adds a counter to SYNC, a check to the RPDO, and a third TPDO, for which the control loop waits.

    Args:
        drives: number of drives on the channel.
        rate: SYNC rate, Hz.
        heartbeat_rate: heartbeats of all participants, 1/s.
        bit_rate: bit/s.
        protected: with end-to-end protection.
    """
    reports = (*TPDO_BYTES, CHECK_BYTES) if protected else TPDO_BYTES
    sync, command = (1, RPDO_BYTES + CHECK_BYTES) if protected else (0, RPDO_BYTES)

    def load(stuffed: bool) -> float:
        per_drive = frame_bits(command, stuffed) + sum(frame_bits(n, stuffed) for n in reports)
        cycle = frame_bits(sync, stuffed) + drives * per_drive
        return (cycle * rate + heartbeat_rate * frame_bits(1, stuffed)) / bit_rate

    awaited = reports if protected else TPDO_BYTES[:1]
    feedback = (frame_bits(sync) + drives * sum(map(frame_bits, awaited))) / bit_rate
    blocking = 0.0 if protected else frame_bits(TPDO_BYTES[1]) / bit_rate
    commands = drives * frame_bits(command) / bit_rate
    return ChannelBudget(drives, rate, load(True), load(False), feedback, 1.0 / rate - feedback - blocking - commands)


def check_budget(
    drives_per_channel: Sequence[int],
    rate: float,
    heartbeat_rate: float = 0.0,
    protected: bool = False,
    limit: float = LOAD_LIMIT,
) -> list[ChannelBudget]:
    """Return the budget of every channel.

    Args:
        drives_per_channel: number of drives on every channel.
        rate: SYNC rate, Hz.
        heartbeat_rate: heartbeats of all participants of a channel, 1/s.
        protected: with end-to-end protection.
        limit: share of the bus that may be taken.

    Raises:
        BusLoadError: the worst-case load of a channel exceeds `limit`; the error prints the whole budget.
    """
    budgets = [channel_budget(drives, rate, heartbeat_rate, protected=protected) for drives in drives_per_channel]
    worst = max(budgets, key=lambda budget: budget.load)
    if worst.load > limit:
        lines = "\n".join(f"  channel {index}: {budget}" for index, budget in enumerate(budgets))
        raise BusLoadError(
            f"{worst.drives} drives on one channel at {rate:g} Hz overload the bus",
            budget=lines,
            value=f"{100 * worst.load:.1f} %",
            limit=f"{100 * limit:.0f} %",
            remedy="spread them over more channels (two at 500 Hz; three, protected five, at 1 kHz) or lower the rate",
        )
    return budgets
