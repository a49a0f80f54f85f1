"""The floor of this machine for a graph of this shape: minimal hand-written processes, no checks, no node code.

force -> admittance -> kinematics -> driver, which sends SYNC and 5 RPDOs to a plant and gets 5 TPDOs back (11 CAN
frames), then `measured_js` to both control processes: each takes and publishes raw bytes in one hand-built wait set,
copies the time of the force sample, and does nothing else. What the robot's graph costs above these figures is its
own; what it cannot get below is the machine's and the middleware's.

    python bench/floor.py [--rate 1000] [--seconds 10] [--priority 40] [--json]
"""

from __future__ import annotations

import argparse
import gc
import json
import multiprocessing
import os
import socket
import statistics
import struct
import time
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.synchronize import Barrier
from typing import Any

from sher3_drivers.bus.frame import FRAME_SIZE, pack_frame
from sher3_runtime import environment
from sher3_runtime.clock import set_timer_slack

PAYLOAD = 200
"""Bytes of a message, about those of a JointState of five axes; the first eight are the time of the force sample."""
STAMP = struct.Struct("<q")
HEADER = b"\x00\x01\x00\x00" + struct.pack("<I", PAYLOAD)
SYNC = pack_frame(0x80)
RPDOS = b"".join(pack_frame(0x201 + i, bytes(6)) for i in range(5))
TPDOS = b"".join(pack_frame(0x181 + i, bytes(8)) for i in range(5))


class Raw:
    """A node without rclpy's layers: one wait set over its subscriptions, bytes in and out."""

    def __init__(self, name: str, takes: tuple[str, ...], publishes: tuple[str, ...]) -> None:
        import rclpy
        from rclpy.impl.implementation_singleton import rclpy_implementation
        from rclpy.qos import QoSProfile, ReliabilityPolicy
        from std_msgs.msg import UInt8MultiArray

        rclpy.init()
        self.node = rclpy.create_node(name, enable_rosout=False, start_parameter_services=False)
        qos = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
        self._kind = UInt8MultiArray
        self.publishers = [self.node.create_publisher(UInt8MultiArray, topic, qos) for topic in publishes]
        subs = [self.node.create_subscription(UInt8MultiArray, topic, print, qos, raw=True) for topic in takes]
        self.handles = [sub.handle for sub in subs]
        for handle in self.handles:
            handle.__enter__()
        self._set = rclpy_implementation.WaitSet(max(1, len(subs)), 0, 0, 0, 0, 0, rclpy.get_default_context().handle)

    def matched(self, readers: int, writers: int) -> bool:
        """Whether so many readers of each publisher and writers of each subscription have been found."""
        enough = all(pub.get_subscription_count() >= readers for pub in self.publishers)
        return enough and all(handle.get_publisher_count() >= writers for handle in self.handles)

    def wait(self, index: int) -> bytes | None:
        """Wait at most 50 ms for a message of subscription `index`; return the newest, dropping those of the others."""
        self._set.clear_entities()
        self._set.add_subscription(self.handles[index])
        self._set.wait(50_000_000)
        newest = None
        for number, handle in enumerate(self.handles):
            while (taken := handle.take_message(self._kind, True)) is not None:
                newest = taken[0] if number == index else newest
        return newest


def message(stamp: int) -> bytes:
    """Return the CDR bytes of a UInt8MultiArray that holds `stamp`: an empty layout, then the data."""
    layout = struct.pack("<II", 0, 0)
    return HEADER[:4] + layout + HEADER[4:] + STAMP.pack(stamp) + bytes(PAYLOAD - STAMP.size)


def stamp_of(data: bytes) -> int:
    return STAMP.unpack_from(data, 16)[0]


def force(raw: Raw, period: int, end: int, can: socket.socket, result: dict[str, Any]) -> None:
    publish, due = raw.publishers[0].publish, time.monotonic_ns()
    while due < end:
        due += period
        time.sleep(max(0.0, (due - time.monotonic_ns()) * 1e-9))
        due += max(0, time.monotonic_ns() - due) // period * period  # a whole period late: skipped, as in the graph
        publish(message(time.monotonic_ns()))


def stage(raw: Raw, period: int, end: int, can: socket.socket, result: dict[str, Any]) -> None:
    publish = raw.publishers[0].publish
    while time.monotonic_ns() < end:
        if (data := raw.wait(0)) is not None:
            publish(message(stamp_of(data)))


def driver(raw: Raw, period: int, end: int, can: socket.socket, result: dict[str, Any]) -> None:
    publish, latencies, can_cycles = raw.publishers[0].publish, [], []
    while time.monotonic_ns() < end:
        if (data := raw.wait(0)) is None:
            continue
        begin, stamp = time.monotonic_ns(), stamp_of(data)
        can.send(SYNC + RPDOS)
        sent = time.monotonic_ns()
        with suppress(TimeoutError):
            can.recv(4096)
            can_cycles.append(time.monotonic_ns() - begin)
        publish(message(stamp))
        latencies.append(sent - stamp)
    result.update(latencies=latencies, can=can_cycles)


def plant(raw: None, period: int, end: int, can: socket.socket, result: dict[str, Any]) -> None:
    while time.monotonic_ns() < end:
        with suppress(TimeoutError):
            if len(can.recv(4096)) == 6 * FRAME_SIZE:
                can.send(TPDOS)


Process = tuple[Callable[..., None], tuple[str, ...], tuple[str, ...], int]
PROCESSES: dict[str, Process] = {
    "force": (force, (), ("force",), 1),
    "admittance": (stage, ("force", "measured_js"), ("servo_cv",), 1),
    "kinematics": (stage, ("servo_cv", "measured_js"), ("servo_jv",), 1),
    "driver": (driver, ("servo_jv",), ("measured_js",), 2),
    "plant": (plant, (), (), 0),
}
"""Function, topics it takes (the first one wakes it), topics it publishes, readers of these."""


def run(name: str, arguments: argparse.Namespace, can: socket.socket, barrier: Barrier, results: Any) -> None:
    """Be one process: meet the others, run, report latencies and processor time."""
    work, takes, publishes, readers = PROCESSES[name]
    raw = Raw(name, takes, publishes) if takes or publishes else None
    while raw is not None and not raw.matched(readers, 1):
        time.sleep(0.01)
    can.settimeout(0.05)
    set_timer_slack()
    gc.collect()
    gc.freeze()
    barrier.wait(30.0)
    with suppress(PermissionError):
        for thread in map(int, os.listdir("/proc/self/task") if arguments.priority else ()):
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(arguments.priority))
    result: dict[str, Any] = {"name": name}
    period, end = round(1e9 / arguments.rate), time.monotonic_ns() + round((arguments.seconds + 1.0) * 1e9)
    begin, begun = time.process_time(), time.monotonic()
    work(raw, period, end, can, result)
    result["cpu"] = 100.0 * (time.process_time() - begin) / (time.monotonic() - begun)
    results.put(result)


def measure(arguments: argparse.Namespace) -> dict[str, Any]:
    """Run the processes; return the figures, the first second left out."""
    environment.apply(arguments.domain)
    context = multiprocessing.get_context("fork")
    barrier, results = context.Barrier(len(PROCESSES)), context.Queue()
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
    ends = {"plant": theirs}
    processes = [
        context.Process(target=run, args=(name, arguments, ends.get(name, ours), barrier, results), daemon=True)
        for name in PROCESSES
    ]
    for process in processes:
        process.start()
    found = {result["name"]: result for result in (results.get(timeout=arguments.seconds + 60.0) for _ in processes)}
    skip = round(arguments.rate)
    latencies, can = sorted(found["driver"]["latencies"][skip:]), sorted(found["driver"]["can"][skip:])
    return {
        "rate": arguments.rate, "priority": arguments.priority, "cycles": len(latencies),
        "lost": round(arguments.rate * arguments.seconds) - len(latencies),
        "p50_us": statistics.median(latencies) / 1e3, "p99_us": latencies[int(0.99 * len(latencies))] / 1e3,
        "max_us": latencies[-1] / 1e3, "can_p50_us": statistics.median(can) / 1e3,
        "cpu_percent": sum(result["cpu"] for result in found.values()),
        "cpu_by_process": {name: round(found[name]["cpu"], 1) for name in PROCESSES},
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rate", type=float, default=1000.0)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--priority", type=int, default=40, help="SCHED_FIFO priority of every thread; 0 for none")
    parser.add_argument("--domain", type=int, default=77)
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    figures = measure(arguments)
    print(json.dumps(figures) if arguments.json else "\n".join(f"{key:>16}  {value}" for key, value in figures.items()))


if __name__ == "__main__":
    main()
