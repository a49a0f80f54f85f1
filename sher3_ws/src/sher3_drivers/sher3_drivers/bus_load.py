"""The bus-load budget: which drives share a channel at which cycle rate, before anything is sent.

Classic CAN, 11-bit identifiers: a frame of n data bytes is 47 + 8 n bits with the inter-frame space, and bit
stuffing adds at most (34 + 8 n - 1) // 4 bits (Davis, Burns, Bril, Lukkien 2007, "Controller Area Network
schedulability analysis", eq. 1).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .errors import BusLoadError

BIT_RATE = 1_000_000
RPDO_BYTES = 6
TPDO_BYTES = (8, 8)
LOAD_LIMIT = 0.90
"""Worst-case share of the bus for cyclic traffic and heartbeats; the rest is for SDO, EMCY and repeats."""


def frame_bits(data_bytes: int, stuffed: bool = True) -> int:
    """Return the bits of one classic frame on the wire, inter-frame space included."""
    return 47 + 8 * data_bytes + ((34 + 8 * data_bytes - 1) // 4 if stuffed else 0)


def fd_frame_seconds(data_bytes: int, arbitration_rate: float = 1e6, data_rate: float = 5e6) -> float:
    """Return the worst-case time of one CAN FD frame with its inter-frame space, s; for comparison only.

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
        load_unstuffed: the same without stuff bits, the least it can be.
        feedback: seconds from SYNC to the last TPDO1 (position, status, torque), worst case.
        slack: seconds left in a cycle between the last TPDO1 and the moment the RPDOs must go out to be in before
            the next SYNC: what the control loop may take. A lower-priority frame that blocks the wire once is
            allowed for.
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


def channel_budget(drives: int, rate: float, heartbeat_rate: float = 0.0, bit_rate: int = BIT_RATE) -> ChannelBudget:
    """Return the budget of SYNC, one RPDO and two TPDOs per drive a cycle, and `heartbeat_rate` heartbeats a second."""

    def load(stuffed: bool) -> float:
        per_drive = frame_bits(RPDO_BYTES, stuffed) + sum(frame_bits(n, stuffed) for n in TPDO_BYTES)
        cycle = frame_bits(0, stuffed) + drives * per_drive
        return (cycle * rate + heartbeat_rate * frame_bits(1, stuffed)) / bit_rate

    feedback = (frame_bits(0) + drives * frame_bits(TPDO_BYTES[0])) / bit_rate
    blocking = frame_bits(TPDO_BYTES[1]) / bit_rate
    commands = drives * frame_bits(RPDO_BYTES) / bit_rate
    return ChannelBudget(drives, rate, load(True), load(False), feedback, 1.0 / rate - feedback - blocking - commands)


def check_budget(
    drives_per_channel: Sequence[int], rate: float, heartbeat_rate: float = 0.0, limit: float = LOAD_LIMIT
) -> list[ChannelBudget]:
    """Return the budget of every channel.

    Raises:
        BusLoadError: a channel's worst-case load exceeds `limit`; it prints the whole budget.
    """
    budgets = [channel_budget(drives, rate, heartbeat_rate) for drives in drives_per_channel]
    worst = max(budgets, key=lambda budget: budget.load)
    if worst.load > limit:
        lines = "\n".join(f"  channel {index}: {budget}" for index, budget in enumerate(budgets))
        raise BusLoadError(
            f"{worst.drives} drives on one channel at {rate:g} Hz overload the bus",
            budget=lines,
            value=f"{100 * worst.load:.1f} %",
            limit=f"{100 * limit:.0f} %",
            remedy="spread the drives over more channels (two at 500 Hz, three at 1 kHz) or lower the rate",
        )
    return budgets
