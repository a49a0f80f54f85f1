"""Two codecs of one format: single messages within a tick, whole columns of a recording. They agree byte for byte."""

from __future__ import annotations

import numpy as np
import pytest
from sher3_bags import stream
from sher3_bags.codec.encode import encode
from sher3_bags.messages import TEXT, TYPES
from sher3_common.samples import (
    JointSample,
    JoySample,
    PoseSample,
    TemperatureSample,
    TextSample,
    TwistSample,
    WrenchSample,
)
from sher3_description import ACTUATORS, TOPICS
from sher3_runtime.codec.cdr import codec

STAMP = 1_700_000_000_123_456_789
FIVE, SIX = (1e-3, -2e-3, 3e-3, 0.1, 4e-3), (0.1, 0.2, 0.3, 0.01, 0.02, 0.03)
SAMPLES = {
    "JointState": (JointSample(STAMP, FIVE, None, FIVE), {"position": [FIVE], "effort": [FIVE]}),
    "TwistStamped": (TwistSample(STAMP, SIX), {"linear": [SIX[:3]], "angular": [SIX[3:]]}),
    "WrenchStamped": (WrenchSample(STAMP, SIX), {"force": [SIX[:3]], "torque": [SIX[3:]]}),
    "PoseStamped": (
        PoseSample(STAMP, SIX[:3], (0.0, 0.6, 0.0, 0.8)),
        {"position": [SIX[:3]], "orientation": [(0.0, 0.6, 0.0, 0.8)]},
    ),
    "Joy": (JoySample(STAMP, (0.5,), (1,)), {"axes": [(0.5,)], "buttons": [(1,)]}),
    "Temperature": (TemperatureSample(STAMP, 21.5), {"temperature": [21.5], "variance": [0.0]}),
    "String": (TextSample("größer"), {"data": ["größer"]}),
}


@pytest.mark.parametrize("name", [name for name, topic in TOPICS.items() if topic.type in TYPES])
def test_both_write_the_same_bytes(name):
    topic = TOPICS[name]
    sample, columns = SAMPLES[topic.type.rsplit("/", 1)[-1]]
    values = columns if topic.type == TEXT else {key: np.array(value) for key, value in columns.items()}
    row = encode(stream(name, [STAMP], **values))
    ours = codec(topic.type, topic.frame, ACTUATORS)
    assert bytes(row.payload) == ours.encode(sample)
    assert ours.decode(bytes(row.payload)) == sample


def test_what_the_columns_cannot_hold_is_known():
    """A report has a list of pairs: recordings keep its bytes, and nothing reads them as columns."""
    assert {topic.type for topic in TOPICS.values()} - set(TYPES) == {"diagnostic_msgs/msg/DiagnosticArray"}
