"""The CAN cycle between two processes: SYNC + 5 RPDO + 10 TPDO over the channels of the default layout.

Three implementations over the same local links, in one run: `driver` is the product (MotorDriver and the mock
drives with an ideal plant), `frames` its floor (raw frames, nothing else), `messages` the same cycle with
python-can Message objects. Round trip: from SYNC handed to the link until the last TPDO is taken in. CPU in per
cent of one core, each process alone. As in the product, both run under SCHED_FIFO where the user may, a tick that is a
whole period late is skipped, and a stop of the driver is counted, named and recovered from.

    python bench/can_bus.py [--rate 1000] [--seconds 10] [--priority 40] [--kind local] [--json]
    python bench/can_bus.py --budget [--json]
"""

from __future__ import annotations

import argparse
import contextlib
import gc
import json
import multiprocessing
import os
import select
import statistics
import struct
import time
from collections.abc import Callable, Iterator
from multiprocessing.connection import Connection

import can
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.bus.frame import FRAME_SIZE, bundle, pack_frame
from sher3_drivers.bus.group import LinkGroup
from sher3_drivers.bus.link import open_links
from sher3_drivers.bus.load import channel_budget, fd_frame_seconds, frame_bits
from sher3_drivers.bus.python_can import LinkBus
from sher3_drivers.canopen.cia402 import Goal
from sher3_drivers.drive.motor_driver import MotorDriver
from sher3_drivers.mock.bus import MockDriveBus
from sher3_drivers.mock.plant import IntegratorPlant
from sher3_drivers.settings import MotorDriverSettings, default_settings
from sher3_runtime.clock import set_timer_slack

ROBOT = load_robot()
_FRAME = struct.Struct("<IB3x8s")
Serve = Callable[[MotorDriverSettings, Callable[[], bool]], None]
Cycle = Callable[[int], float]


STOPS: list[str] = []
"""Why the driver stopped during a measurement."""


def realtime(priority: int) -> None:
    """Run under SCHED_FIFO with this priority, 0 for none, where the user may."""
    with contextlib.suppress(PermissionError):
        os.sched_setscheduler(0, os.SCHED_FIFO if priority else os.SCHED_OTHER, os.sched_param(priority))


def device_driver(settings: MotorDriverSettings, stopped: Callable[[], bool]) -> None:
    """Serve the product's device side."""
    links = open_links([channel.link for channel in settings.channels])
    mock = MockDriveBus(links, IntegratorPlant(ROBOT, settings.period), ROBOT, settings)
    while not stopped():
        mock.serve(0.005)
    mock.close()


def host_driver(settings: MotorDriverSettings) -> tuple[Cycle, Callable[[], object]]:
    """Return the product's host side: enabled and moving."""
    driver = MotorDriver(ROBOT, settings, open_links([channel.link for channel in settings.channels]))
    driver.configure(2.0)
    driver.enable()
    velocity = [0.001, -0.001, 0.001, 0.01, -0.001]

    def cycle(stamp: int) -> float:
        begin = time.perf_counter_ns()
        driver.hear_supervisor()
        driver.tick(stamp)
        driver.collect_positions()  # TPDOs come in one datagram: with the positions everything is in
        end = time.perf_counter_ns()
        complete = driver.collect()
        if not driver.enabled:
            recover(driver)
            return float("nan")
        driver.command(stamp, velocity)
        return (end - begin) / 1e3 if complete else float("nan")

    return cycle, driver.close


def recover(driver: MotorDriver) -> None:
    """Note why the driver stopped, and go on: reset, then enable."""
    if driver.stop.first is not None:
        STOPS.append(f"{driver.stop.code.name}: {driver.stop.reason}")
    if driver.needs_reset:
        driver.reset()
    elif driver.goal is not Goal.ENABLED:
        driver.enable()


def device_frames(settings: MotorDriverSettings, stopped: Callable[[], bool]) -> None:
    """Send ten precomputed TPDOs for each SYNC, raw."""
    group = LinkGroup(open_links([channel.link for channel in settings.channels]))
    answers = bundle([b"".join(tpdos(channel.drives)) for channel in settings.channels])
    while not stopped():
        if 0x80 in {can_id for can_id, _, _ in _FRAME.iter_unpack(group.receive(0.005))}:
            group.send(answers)
    group.close()


def host_frames(settings: MotorDriverSettings) -> tuple[Cycle, Callable[[], object]]:
    """Return SYNC, ten TPDOs in, five RPDOs out, raw."""
    group = LinkGroup(open_links([channel.link for channel in settings.channels]))
    sync = bundle([pack_frame(0x80)] * len(group.links))
    commands = bundle([b"".join(rpdos(channel.drives)) for channel in settings.channels])

    def cycle(stamp: int) -> float:
        begin = time.perf_counter_ns()
        group.send(sync)
        count, deadline = 0, time.monotonic() + settings.period
        while count < 10 and (left := deadline - time.monotonic()) > 0:
            count += len(group.receive(left)) // FRAME_SIZE
        end = time.perf_counter_ns()
        group.send(commands)
        return (end - begin) / 1e3 if count == 10 else float("nan")

    return cycle, group.close


def device_messages(settings: MotorDriverSettings, stopped: Callable[[], bool]) -> None:
    """Send ten TPDOs for each SYNC as python-can messages."""
    buses = [LinkBus(alone(channel.link)) for channel in settings.channels]
    while not stopped():
        select.select(buses, (), (), 0.005)
        for bus, channel in zip(buses, settings.channels, strict=True):
            while (message := bus.recv(0.0)) is not None:
                if message.arbitration_id == 0x80:
                    for frame in tpdos(channel.drives):
                        bus.send(as_message(frame))
    for bus in buses:
        bus.shutdown()


def host_messages(settings: MotorDriverSettings) -> tuple[Cycle, Callable[[], object]]:
    """Return the cycle with python-can messages."""
    buses = [LinkBus(alone(channel.link)) for channel in settings.channels]

    def cycle(stamp: int) -> float:
        begin = time.perf_counter_ns()
        for bus in buses:
            bus.send(can.Message(arbitration_id=0x80, is_extended_id=False))
        count, deadline = 0, time.monotonic() + settings.period
        while count < 10 and time.monotonic() < deadline:
            select.select(buses, (), (), max(0.0, deadline - time.monotonic()))
            for bus in buses:
                while bus.recv(0.0) is not None:
                    count += 1
        end = time.perf_counter_ns()
        for bus, channel in zip(buses, settings.channels, strict=True):
            for frame in rpdos(channel.drives):
                bus.send(as_message(frame))
        return (end - begin) / 1e3 if count == 10 else float("nan")

    return cycle, lambda: [bus.shutdown() for bus in buses]


def alone(link: str) -> str:
    """Return the name of a channel with a cable of its own: python-can knows no bundles."""
    return link.replace("/", "-")


def tpdos(drives: tuple[str, ...]) -> list[bytes]:
    return [pack_frame(base + 1 + ACTUATORS.index(name), bytes(8)) for base in (0x180, 0x280) for name in drives]


def rpdos(drives: tuple[str, ...]) -> list[bytes]:
    return [pack_frame(0x201 + ACTUATORS.index(name), bytes(6)) for name in drives]


def as_message(frame: bytes) -> can.Message:
    can_id, length, data = _FRAME.unpack(frame)
    return can.Message(arbitration_id=can_id, is_extended_id=False, data=data[:length])


SIDES: dict[str, tuple[Serve, Callable[..., tuple[Cycle, Callable[[], object]]]]] = {
    "driver": (device_driver, host_driver),
    "frames": (device_frames, host_frames),
    "messages": (device_messages, host_messages),
}


def device_process(serve: Serve, settings: MotorDriverSettings, priority: int, pipe: Connection) -> None:
    """Serve until told to stop; report the CPU time used between `start` and `stop`."""
    begun = time.process_time()
    realtime(priority)

    def stopped() -> bool:
        nonlocal begun
        if not pipe.poll():
            return False
        if pipe.recv() == "start":
            begun = time.process_time()
            return False
        pipe.send(time.process_time() - begun)
        return True

    serve(settings, stopped)


def measure(name: str, settings: MotorDriverSettings, seconds: float, priority: int) -> dict[str, object]:
    """Run one implementation; return its figures."""
    serve, make_host = SIDES[name]
    ours, theirs = multiprocessing.Pipe()
    device = multiprocessing.get_context("fork").Process(
        target=device_process, args=(serve, settings, priority, theirs)
    )
    device.start()
    time.sleep(0.3)
    realtime(priority)
    cycle, close = make_host(settings)
    period = round(settings.period * 1e9)
    ticks = round(seconds / settings.period)
    for stamp in paced(period, 200):  # enables the drives, warms up
        cycle(stamp)
    STOPS.clear()
    ours.send("start")
    cpu, wall = time.process_time(), time.perf_counter()
    trips = [cycle(stamp) for stamp in paced(period, ticks)]
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    ours.send("stop")
    device_cpu = ours.recv()
    close()
    device.join(2.0)
    realtime(0)
    good = sorted(t for t in trips if t == t)
    return {
        "implementation": name, "rate": 1.0 / settings.period, "channels": len(settings.channels), "cycles": ticks,
        "lost": ticks - len(trips), "incomplete": len(trips) - len(good), "stops": len(STOPS),
        "p50_us": statistics.median(good), "p99_us": good[int(0.99 * len(good))], "max_us": good[-1],
        "host_cpu_percent": 100 * cpu / wall, "device_cpu_percent": 100 * device_cpu / wall,
        "reason": STOPS[0] if STOPS else "",
    }  # fmt: skip


def paced(period: int, ticks: int) -> Iterator[int]:
    """Yield `ticks` times of a grid [ns] as they come, without those that are a whole period over."""
    start = time.monotonic_ns() + period
    for due in range(start, start + ticks * period, period):
        time.sleep(max(0.0, (due - time.monotonic_ns()) * 1e-9))
        if time.monotonic_ns() - due < period:
            yield due


def budget_rows() -> list[dict[str, float]]:
    """Return the bus-load table of docs/reference/can.md."""
    rows = []
    for rate in (200.0, 500.0, 1000.0):
        for drives in (1, 2, 3, 5):
            b, cyclic = channel_budget(drives, rate, 200.0 + 20.0 * drives), channel_budget(drives, rate)
            checked = channel_budget(drives, rate, protected=True)
            rows.append({
                "rate": rate, "drives": drives, "load_percent": 100 * cyclic.load,
                "with_heartbeats_percent": 100 * b.load, "unstuffed_percent": 100 * cyclic.load_unstuffed,
                "feedback_us": 1e6 * b.feedback, "slack_us": 1e6 * b.slack,
                "protected_percent": 100 * checked.load, "protected_slack_us": 1e6 * checked.slack,
            })  # fmt: skip
    return rows


def alternative_rows() -> list[dict[str, object]]:
    """Return other mappings of the five drives at 1 kHz, worst case: frames per cycle on the fullest channel."""
    sync, six, eight = frame_bits(0), frame_bits(6), frame_bits(8)
    classic = {
        "three channels (2, 2, 1), RPDO6 + 2 TPDO8: ours": sync + 2 * (six + 2 * eight),
        "one channel, RPDO6 + 2 TPDO8": sync + 5 * (six + 2 * eight),
        "two channels (3, 2), RPDO6 + 2 TPDO8": sync + 3 * (six + 2 * eight),
        "two channels, RPDO6 + TPDO8 (no motor encoder, no echo)": sync + 3 * (six + eight),
        "two channels, one group RPDO8 of int16 + 2 TPDO8": sync + eight + 3 * 2 * eight,
        "one channel, two group RPDO8 of int16 + TPDO8": sync + 2 * eight + 5 * eight,
    }
    fd = fd_frame_seconds(0) + 5 * (fd_frame_seconds(6) + fd_frame_seconds(16))
    rows: list[dict[str, object]] = [{"mapping": name, "load_percent": bits / 10.0} for name, bits in classic.items()]
    return [*rows, {"mapping": "one CAN FD channel 1/5 Mbit/s, RPDO6 + TPDO16", "load_percent": 1e5 * fd}]


def show(rows: list[dict[str, object]] | list[dict[str, float]]) -> None:
    print("  ".join(f"{key:>{max(len(key), 10)}}" for key in rows[0]))
    for row in rows:
        cells = [f"{v:.1f}" if isinstance(v, float) else str(v) for v in row.values()]
        print("  ".join(f"{cell:>{max(len(key), 10)}}" for key, cell in zip(row, cells, strict=True)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rate", type=float, nargs="*", default=[500.0, 1000.0])
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--priority", type=int, default=40, help="SCHED_FIFO priority as in the product; 0 for none")
    parser.add_argument("--kind", default="local", help="link kind of the channels; socketcan needs can0, can1, can2")
    parser.add_argument("--links", help="comma-separated link specifications instead of --kind")
    parser.add_argument("--budget", action="store_true", help="print the bus-load budget and exit")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    if arguments.budget:
        rows: list = budget_rows()
        alternatives = alternative_rows()
        if arguments.json:
            print(json.dumps({"budget": rows, "alternatives_at_1_khz": alternatives}))
            return
        show(rows)
        rows = alternatives
    else:
        set_timer_slack()
        gc.freeze()
        rows = []
        for rate in arguments.rate:
            names = arguments.links.split(",") if arguments.links else None
            for name in SIDES:
                settings = default_settings(1.0 / rate, names, arguments.kind)
                if names is None:
                    links = [f"{arguments.kind}:bench{os.getpid()}/{i}" for i in range(len(settings.channels))]
                    settings = default_settings(1.0 / rate, links)
                rows.append(measure(name, settings, arguments.seconds, arguments.priority))
    print(json.dumps(rows)) if arguments.json else show(rows)


if __name__ == "__main__":
    main()
