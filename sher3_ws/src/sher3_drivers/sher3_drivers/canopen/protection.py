"""End-to-end protection of commands and reports: they are whole, of their drive, and of this SYNC.

Every SYNC carries a counter (CiA 301, object 0x1019), which the host and every drive know. Behind a command, and behind
the two reports of a tick, go 16 bits: the CRC (polynomial 0x1021) of their bytes, begun with node id and counter. A CRC
is a one-to-one map of what it begins with, so a report of another drive or of another of the last 239 SYNCs never
passes, whatever it says; one that was garbled passes once in 65536. What this does for a command, CANopen Safety (EN
50325-5) does by sending it twice, the second time inverted.
"""

from __future__ import annotations

from binascii import crc_hqx

COUNTS = 240
"""Largest value of the counter of SYNC, and the largest that CiA 301 allows; behind it comes 1."""
OLDEST_COMMAND = 3
"""SYNCs since which a command may have been sent: the host sends zero once its newest command is 4 periods old."""
OLDEST_REPORT = 16
"""SYNCs back to which the age of a stale report is named."""


def count_after(counter: int) -> int:
    """Return the counter of the next SYNC; 0 stands for none so far."""
    return counter % COUNTS + 1


def count_before(counter: int, age: int) -> int:
    """Return the counter of the SYNC `age` SYNCs before."""
    return (counter - age - 1) % COUNTS + 1


def check_of(data: bytes, node_id: int, counter: int) -> int:
    """Return the check of `data` that belongs to a node id and a SYNC."""
    return crc_hqx(data, node_id << 8 | counter)
