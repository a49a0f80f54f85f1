"""One message to bytes and back: the runtime's codec, rclpy's message objects, and one row of the codec of bags.

python bench/codec.py           # us per message, the best of 200 rounds of 50
python bench/codec.py --json
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable

import numpy as np
from rclpy.serialization import deserialize_message, serialize_message
from sher3_bags import stream
from sher3_bags.codec.encode import encode
from sher3_common.samples import JointSample, WrenchSample
from sher3_description import ACTUATORS, TOPICS
from sher3_runtime import environment
from sher3_runtime.codec.cdr import codec
from sher3_runtime.codec.messages import from_message, message_class, to_message

ROUNDS, MESSAGES = 200, 50
STAMP = 1_700_000_000_000_000_000
SAMPLES = {
    "measured_js": JointSample(STAMP, (1e-3, 2e-3, 3e-3, 0.1, 4e-3), (1e-4, 2e-4, 3e-4, 0.01, 4e-4)),
    "force/measured_cf": WrenchSample(STAMP, (0.1, 0.2, 0.3, 0.01, 0.02, 0.03)),
}
COLUMNS = {
    "measured_js": {"position": np.zeros((1, 5)), "velocity": np.zeros((1, 5))},
    "force/measured_cf": {"force": np.zeros((1, 3)), "torque": np.zeros((1, 3))},
}


def microseconds(action: Callable[[], object]) -> float:
    """Return the time of one call [us], the best of several rounds."""
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for _ in range(MESSAGES):
            action()
        times.append((time.perf_counter() - start) / MESSAGES * 1e6)
    return round(min(times), 2)


def measured(name: str) -> dict[str, float]:
    """Return the times of one topic [us]."""
    topic, sample = TOPICS[name], SAMPLES[name]
    ours, kind = codec(topic.type, topic.frame, ACTUATORS), message_class(topic.type)
    data = ours.encode(sample)
    row = stream(name, np.array([STAMP]), **COLUMNS[name])
    return {
        "encode": microseconds(lambda: ours.encode(sample)),
        "decode": microseconds(lambda: ours.decode(data)),
        "rclpy encode": microseconds(lambda: serialize_message(to_message(topic, sample))),
        "rclpy decode": microseconds(lambda: from_message(topic, deserialize_message(data, kind))),
        "bags, one row": microseconds(lambda: encode(row)),
    }


def main() -> None:
    """Print the times of a joint state and of a wrench."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print one JSON object instead of text")
    arguments = parser.parse_args()
    environment.apply()
    found = {name: measured(name) for name in SAMPLES}
    if arguments.json:
        print(json.dumps(found))
        return
    for name, times in found.items():
        print(f"{name:18} " + "  ".join(f"{what} {time:.3g}" for what, time in times.items()))


if __name__ == "__main__":
    main()
