"""Samples in shared memory: all of them in order, across processes, and a reader that is late knows what it missed."""

from __future__ import annotations

import os
import random
import signal
import struct
import time
from multiprocessing import get_context

import pytest
from sher3_common.samples import JoySample, TwistSample
from sher3_description.topics import TOPICS
from sher3_runtime.codec.cdr import codec
from sher3_runtime.composed.composition import REPEATS, Composition
from sher3_runtime.composed.newest import Newest
from sher3_runtime.composed.ring import Ring, share

ZERO = (0.0,) * 6
RANKS = {name: rank for rank, name in enumerate(TOPICS)}


def test_records_come_in_order_whatever_their_length_over_many_turns():
    ring, dice = Ring(1 << 18), random.Random(1)
    reader, written, got = ring.join(), [], []
    for number in range(20_000):
        written.append((number % 64, number, dice.randbytes(dice.randrange(90))))
        ring.put(written[-1:])
        if number % 100 == 0:
            got += reader.read()
    assert got + reader.read() == written and reader.lost == 0


def test_a_reader_that_is_late_counts_what_it_missed_and_goes_on():
    ring = Ring(1 << 18)
    reader = ring.join()
    for number in range(3000):
        ring.put([(1, number, bytes(84))])
    assert reader.read() == [] and reader.lost == 3000 * (16 + 88)
    ring.put([(2, 7, b"next")])
    assert reader.read() == [(2, 7, b"next")]


def test_a_reader_that_has_died_counts_no_more():
    ring, context = Ring(1 << 18), get_context("fork")
    other = context.Process(target=ring.join)
    other.start()
    other.join()
    assert ring.readers(5) == (0, 0)
    ring.join()
    assert ring.readers(5) == (1, 0)


def test_a_reader_of_some_topics_needs_no_message_of_these():
    ring = Ring(1 << 18)
    reader = ring.join([1, 2])
    reader.take_too(3)
    assert [ring.readers(rank) for rank in (0, 1, 2, 3)] == [(0, 0), (1, 0), (1, 0), (1, 1)]
    for rank in range(4):
        ring.put([(rank, 10 + rank, b"x")])
    assert reader.read({1, 3}) == [(1, 11, b"x"), (3, 13, b"x")]


def test_a_ring_has_room_for_a_few_readers_and_for_every_topic():
    ring = Ring(1 << 18)
    for _ in range(4):
        ring.join()
    with pytest.raises(BufferError, match="4 processes"):
        ring.join()
    ring.offer(RANKS.values())
    assert ring.offered == set(RANKS.values()) and len(TOPICS) <= 64


def test_another_process_never_sees_a_record_half_written():
    """A writer at full speed in another process, over dozens of turns: each record is whole, or is missed."""
    ring = Ring(1 << 20)
    reader, pid = ring.join(), os.fork()
    if pid == 0:
        for number in range(300_000):
            ring.put([(number % 40, number, struct.pack("<q", number) * (1 + number % 12))])
            if number % 2000 == 0:
                time.sleep(0.002)
        os.kill(os.getpid(), signal.SIGKILL)  # it shares the test's own buffers and must not write them
    seen, last = 0, -1
    while True:
        ended = os.waitpid(pid, os.WNOHANG)[0] != 0
        for rank, number, data in reader.read():
            assert number > last and rank == number % 40
            assert data == struct.pack("<q", number) * (1 + number % 12)
            seen, last = seen + 1, number
        if ended:
            break
    assert seen > 1000 and (seen == 300_000 or reader.lost > 0)


@pytest.mark.parametrize(("listeners", "messages"), [(0, 0), (1, 0), (2, 1)])
def test_what_is_published_inside_is_in_the_ring_and_is_sent_for_others_only(listeners, messages):
    """One reader subscribes as well, as the supervisor does; whoever else listens gets a message."""
    ring, sent = Ring(), []
    together, topic = Composition(ring), TOPICS["servo_cv"]
    encode = codec(topic.type, topic.frame_id).encode
    ring.join([RANKS["servo_cv"]]).take_too(RANKS["servo_cv"])
    reader = ring.join()
    publish = together.publisher(topic, None, encode, sent.append, lambda: listeners, lambda: 42)
    together.begin()
    assert ring.offered == {RANKS["servo_cv"]}
    publish(TwistSample(2, ZERO))
    together.flush()
    assert len(sent) == messages and reader.read() == [(RANKS["servo_cv"], 42, encode(TwistSample(2, ZERO)))]


def test_nothing_is_written_while_nobody_reads():
    ring, topic = Ring(), TOPICS["servo_cv"]
    together = Composition(ring)
    together.publisher(topic, None, codec(topic.type, topic.frame_id).encode, print, lambda: 0, int)(
        TwistSample(1, ZERO)
    )
    together.flush()
    assert ring.written == 0


@pytest.mark.parametrize("name", ["diagnostics", "operating_state"])
def test_topics_of_many_senders_and_latched_ones_stay_with_the_middleware(name):
    ring = Ring()
    together = Composition(ring)
    ring.join()
    together.publisher(TOPICS[name], None, bytes, bytes, lambda: 0, lambda: 0)
    together.begin()
    assert ring.offered == set() and not together.beside(name)()


def test_a_stream_that_is_made_on_demand_is_made_for_a_reader_of_the_ring():
    ring = Ring()
    wanted = Composition(ring).beside("drives/measured_js")
    assert not wanted()
    ring.join()
    assert wanted()


def test_a_node_that_looks_finds_the_newest_samples_of_each_topic_once():
    ring = Ring()
    share([ring])
    try:
        newest = Newest()
    finally:
        share(())
    force, joints = newest.look_at("force/measured_cf", 2), newest.look_at("measured_js", 1)
    ring.offer([force, joints])
    for number in range(3):
        ring.put([(force, number, b"force %d" % number)])
        ring.put([(RANKS["servo_cv"], number, b"not looked at")])
    ring.put([(joints, 3, b"joints")])
    assert newest.take(force) == [b"force 1", b"force 2"] and newest.take(force) == []
    assert newest.take(joints) == [b"joints"] and newest.take(joints) == []


def test_a_topic_that_does_not_come_by_ring_is_left_to_the_subscription():
    ring = Ring()
    share([ring])
    newest = Newest()
    share(())
    beat = newest.look_at("supervisor/heartbeat", 1)
    ring.put([(beat, 1, b"of somebody else")])
    assert newest.take(beat) == [] and not newest.offers(beat)


def test_a_change_of_the_emergency_stop_is_sent_at_once_to_who_reads_the_ring():
    """All samples are in the ring; the first one, each change and a few behind it are messages too."""
    ring, sent = Ring(), []
    together, topic = Composition(ring), TOPICS["pedal/measured"]
    codec_of_pedal = codec(topic.type, topic.frame_id)
    ring.join([RANKS[topic.name]]).take_too(RANKS[topic.name])
    reader = ring.join()
    publish = together.publisher(topic, None, codec_of_pedal.encode, sent.append, lambda: 1, lambda: 42)
    together.begin()
    samples = [JoySample(k, (0.25,), (int(200 <= k < 203),)) for k in range(400)]
    for sample in samples:
        publish(sample)
        together.flush()
    assert [codec_of_pedal.decode(data) for _, _, data in reader.read()] == samples
    expected = [*range(REPEATS), *range(200, 203 + REPEATS)]
    assert [codec_of_pedal.decode(data).stamp for data in sent] == expected
