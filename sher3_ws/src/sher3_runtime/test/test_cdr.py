"""The codecs against rclpy's own serialisation, and against garbage."""

import math
import random
import struct
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rclpy.serialization import deserialize_message, serialize_message
from sher3_common.samples import (
    DiagnosticSample,
    JointSample,
    JoySample,
    PoseSample,
    TemperatureSample,
    TextSample,
    TwistSample,
    WrenchSample,
)
from sher3_description.topics import TOPICS
from sher3_runtime.codec import messages
from sher3_runtime.codec.cdr import CdrError, codec

JOINTS = ("delta_1", "delta_2", "delta_3", "roll", "tilt")
STAMP = 1_700_000_000_123_456_789
FIVE = (0.001, -0.002, 0.003, 0.4, -0.005)
SAMPLES = {
    "JointState": [JointSample(STAMP, *(FIVE if key >> bit & 1 else None for bit in range(3))) for key in range(8)],
    "TwistStamped": [TwistSample(STAMP, (1.0, 2.0, 3.0, 4.0, 5.0, 6.0))],
    "WrenchStamped": [WrenchSample(STAMP, (1.0, 2.0, 3.0, 4.0, 5.0, math.inf))],
    "PoseStamped": [PoseSample(STAMP, (1.0, 2.0, 3.0), (0.0, 0.0, 0.6, 0.8))],
    "Joy": [JoySample(STAMP, (0.5,), (1,)), JoySample(STAMP, (), (0, 1, 2))],
    "String": [TextSample("ENABLED"), TextSample(""), TextSample("Nadelspitze µm")],
    "Temperature": [TemperatureSample(STAMP, 22.0)],
    "DiagnosticArray": [DiagnosticSample(STAMP, "sher3/force_sensor", 1, "late", (("period", "2.0"), ("lost", "")))],
}
CASES = [(topic, sample) for topic in TOPICS.values() for sample in SAMPLES[topic.type.rsplit("/", 1)[-1]]]


@pytest.mark.parametrize(("topic", "sample"), CASES, ids=lambda x: getattr(x, "name", None))
def test_equals_rclpy_both_ways(topic, sample):
    """Either side reads the other's bytes (padding bytes of rclpy are undefined, so the bytes themselves differ)."""
    encode, decode = codec(topic.type, topic.frame_id, JOINTS)
    message = messages.to_message(topic, sample)
    theirs = bytes(serialize_message(message))
    ours = encode(sample)
    assert decode(ours) == sample
    assert decode(theirs) == sample
    assert deserialize_message(ours, type(message)) == message
    assert messages.from_message(topic, message) == sample


@pytest.mark.parametrize(("topic", "sample"), CASES, ids=lambda x: getattr(x, "name", None))
def test_garbage_raises_only_cdr_error(topic, sample):
    """Every truncation and a thousand bit flips: a sample of the right type or a CdrError, never anything else."""
    encode, decode = codec(topic.type, topic.frame_id, JOINTS)
    good = encode(sample)
    for length in range(len(good) - 1):
        with pytest.raises(CdrError):
            decode(good[:length])
    rng = random.Random(1)
    for _ in range(1000):
        bad = bytearray(good)
        for _ in range(rng.randint(1, 4)):
            bad[rng.randrange(len(bad))] ^= 1 << rng.randrange(8)
        with suppress(CdrError):
            assert type(decode(bytes(bad))) is type(sample)


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=400))
def test_random_bytes(data):
    """Nothing but a CdrError comes out of arbitrary bytes."""
    for name in SAMPLES:
        with suppress(CdrError):
            codec(name, "b", JOINTS).decode(b"\0\1\0\0" + data)


def test_a_huge_sequence_costs_nothing():
    """A length field of four billion is refused before anything is allocated."""
    encode, decode = codec("Joy")
    data = bytearray(encode(JoySample(0, (), ())))
    data[-8:-4] = b"\xff\xff\xff\xff"
    with pytest.raises(CdrError, match="4294967295"):
        decode(bytes(data))


def test_wrong_frame_names_and_lengths_are_named():
    """A message that is valid CDR but not of this topic."""
    tip = codec("PoseStamped", "b")
    with pytest.raises(CdrError, match=r"frame_id.*'t'.*'b'"):
        tip.decode(codec("PoseStamped", "t").encode(SAMPLES["PoseStamped"][0]))
    joints = codec("JointState", "", JOINTS)
    for names in (JOINTS[:4], (*JOINTS[:4], JOINTS[0]), ()):
        values = FIVE[: len(names)]
        with pytest.raises(CdrError, match="joint names differ"):
            joints.decode(codec("JointState", "", names).encode(JointSample(0, values)))
    with pytest.raises(CdrError, match="cannot be sent"):
        joints.encode(JointSample(0, (1.0, 2.0)))
    with pytest.raises(CdrError, match="cannot be sent"):
        codec("Joy").encode(JoySample(0, ("full",), (1,)))
    for text in ("a\0b", "x" * 70_000, None):
        with pytest.raises(CdrError, match="cannot be sent"):
            codec("String").encode(TextSample(text))
    with pytest.raises(CdrError, match="no codec"):
        codec("sensor_msgs/msg/Image")


def test_joints_go_by_their_names_and_not_by_their_place():
    reversed_names = codec("JointState", "", (*JOINTS[::-1],))
    data = reversed_names.encode(JointSample(7, FIVE, None, FIVE[::-1]))
    assert codec("JointState", "", JOINTS).decode(data) == JointSample(7, FIVE[::-1], None, FIVE)


def test_big_endian_is_read():
    """CDR of the other byte order is legal."""
    encode, decode = codec("TwistStamped", "b")
    sample = SAMPLES["TwistStamped"][0]
    sec, nanosec = divmod(STAMP, 1_000_000_000)
    data = b"\0\0\0\0" + struct.pack(">iII2s2x6d", sec, nanosec, 2, b"b\0", *sample.twist)
    assert len(data) - 4 == len(encode(sample)) - 4
    assert decode(data) == sample
