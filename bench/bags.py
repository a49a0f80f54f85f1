"""Reading and writing bags: the columnar reader beside independent ones, on one run of all topics.

python bench/bags.py            # 60 s at 500 Hz, ten topics
python bench/bags.py --json
"""

from __future__ import annotations

import argparse
import json
import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from sher3_bags import Recorder, Run, RunMetadata, read_run, recover, stream, write_run
from sher3_bags.codec.encode import encode
from sher3_description import load_robot

T = 2_000_000


def synthetic(seconds: float) -> Run:
    """Return a run of all streams at 500 Hz whose numbers are as hard to compress as recorded ones."""
    rng = np.random.default_rng(0)
    n = round(seconds * 500)
    stamp = 1_700_000_000_000_000_000 + np.arange(n) * T
    count = 2.44140625e-07

    def joints() -> np.ndarray:
        return np.rint(rng.normal(size=(n, 5)).cumsum(axis=0) * 1e-5 / count) * count

    def vectors(k: int) -> np.ndarray:
        return rng.normal(size=(n, k))

    q, v = joints(), joints()
    streams = {
        "setpoint_js": stream("setpoint_js", stamp, position=q, velocity=v),
        "servo_cv": stream("servo_cv", stamp, linear=vectors(3), angular=vectors(3)),
        "servo_jv": stream("servo_jv", stamp, velocity=v),
        "drives/setpoint_jv": stream("drives/setpoint_jv", stamp, velocity=v),
        "drives/measured_js": stream("drives/measured_js", stamp, position=q, velocity=v, effort=joints()),
        "measured_js": stream("measured_js", stamp, position=joints()),
        "measured_cp": stream("measured_cp", stamp, position=vectors(3), orientation=vectors(4)),
        "force/measured_cf": stream(
            "force/measured_cf", stamp, force=np.round(vectors(3) * 320) / 320, torque=np.round(vectors(3) * 64) / 64
        ),
        "pedal/measured": stream("pedal/measured", stamp, axes=np.ones((n, 1)), buttons=np.zeros((n, 1))),
        "tracker/measured_cp": stream("tracker/measured_cp", stamp, position=vectors(3), orientation=vectors(4)),
    }
    return Run(streams, RunMetadata("bench"), load_robot().to_yaml())


def best(action: Callable[[], object], repeats: int) -> float:
    """Return the shortest of several times in s."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return min(times)


def with_rosbags(path: Path) -> int:
    """Read and deserialise every message with rosbags."""
    from rosbags.highlevel import AnyReader

    with AnyReader([path]) as reader:
        return sum(1 for c, _, raw in reader.messages() if reader.deserialize(raw, c.msgtype) is not None)


def with_mcap_ros2(path: Path) -> int:
    """Read and decode every message with mcap and mcap-ros2-support."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    with next(path.glob("*.mcap")).open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        return sum(1 for _ in reader.iter_decoded_messages())


def record(folder: Path, run: Run, limit: int) -> dict[str, float]:
    """Hand the first messages of a run to the recorder one by one; return mean and longest time of a write in us."""
    messages = []
    for topic, table in run.streams.items():
        coded = encode(table)
        for k in range(min(len(table), limit // len(run.streams))):
            start = coded.start[k]
            messages.append((int(table.stamp[k]), topic, coded.payload[start : start + coded.length[k]].tobytes()))
    messages.sort(key=lambda message: message[0])
    longest, begin = 0.0, time.perf_counter()
    with Recorder(folder, load_robot()) as recorder:
        opened = time.perf_counter()
        for stamp, topic, data in messages:
            start = time.perf_counter()
            recorder.write(topic, data, stamp)
            longest = max(longest, time.perf_counter() - start)
        mean = (time.perf_counter() - opened) / len(messages)
    return {"open_s": opened - begin, "us_per_message": mean * 1e6, "longest_ms": longest * 1e3}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="length of the run")
    parser.add_argument("--repeats", type=int, default=5, help="repeats of our reader and writer; the best counts")
    parser.add_argument("--skip-others", action="store_true", help="time only our own reader")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    run = synthetic(options.seconds)
    messages = sum(len(table) for table in run.streams.values())
    result: dict[str, object] = {"seconds": options.seconds, "messages": messages, "cores": os.cpu_count()}
    with tempfile.TemporaryDirectory() as folder:
        bag = Path(folder, "bag")
        write = best(lambda: write_run(bag, run, overwrite=True), options.repeats)
        size = next(bag.glob("*.mcap")).stat().st_size
        read = best(lambda: read_run(bag), options.repeats)
        result["write_run"] = {
            "s": write,
            "us_per_message": write / messages * 1e6,
            "bytes_per_message": size / messages,
        }
        readers: dict[str, dict[str, float]] = {"read_run": {"s": read, "us_per_message": read / messages * 1e6}}
        if not options.skip_others:
            for name, action in (("rosbags", with_rosbags), ("mcap-ros2-support", with_mcap_ros2)):
                seconds = best(lambda action=action: action(bag), 1)  # type: ignore[misc]
                readers[name] = {
                    "s": seconds,
                    "us_per_message": seconds / messages * 1e6,
                    "times_slower": seconds / read,
                }
        result["readers"] = readers
        result["recorder"] = record(Path(folder, "recorded"), run, 60_000)
        cut = Path(folder, "cut.mcap")
        cut.write_bytes(next(bag.glob("*.mcap")).read_bytes()[: size * 2 // 3])
        start = time.perf_counter()
        kept = recover(cut)
        seconds = time.perf_counter() - start
        result["recover"] = {"s": seconds, "messages": sum(kept.messages.values())}
    if options.json:
        print(json.dumps(result, indent=1))
        return
    print(f"{messages} messages, {options.seconds:g} s of ten topics at 500 Hz")
    for name, entry in {"write_run": result["write_run"], **readers, "recorder": result["recorder"]}.items():
        print(f"{name:18}", "  ".join(f"{key} {value:.3g}" for key, value in entry.items()))  # type: ignore[attr-defined]
    print(f"{'recover':18}", f"s {seconds:.3g}  messages {sum(kept.messages.values())} of {messages}, file cut at 2/3")


if __name__ == "__main__":
    main()
