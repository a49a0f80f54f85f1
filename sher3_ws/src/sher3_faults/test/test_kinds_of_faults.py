"""Each kind of fault does to a stream what its name says, the same on every kind of item, and the same for a seed."""

from __future__ import annotations

import math
from itertools import chain
from random import Random

import pytest
from sher3_drivers.bus.frame import ERROR_FLAG, iter_frames, pack_frame
from sher3_drivers.pedal.device import PedalState
from sher3_drivers.sensor.device import WrenchRecord
from sher3_faults.items import BusFrames, Columns, DriveFrames, Numbers, PedalStates, WrenchRecords
from sher3_faults.kinds import KINDS

MS = 1_000_000
STREAMS = {
    "frames": (BusFrames(), [pack_frame(0x181, bytes([i] * 8)) for i in range(20)]),
    "drive": (DriveFrames(), [pack_frame(0x181, bytes([i] * 8)) for i in range(20)]),
    "wrenches": (WrenchRecords(), [WrenchRecord((0.1 * i, 0.0, 0.0, 0.0, 0.0, 0.0), i) for i in range(20)]),
    "pedal": (PedalStates(), [PedalState(0.05 * i, False) for i in range(20)]),
    "numbers": (Numbers(1.0), [0.1 * i for i in range(20)]),
}


@pytest.fixture(params=STREAMS)
def stream(request):
    return STREAMS[request.param]


def flat(parts):
    return list(chain.from_iterable(parts))


def through(kind, items, sent, /, seed=1, **parameters):
    """Send items through a fault, one every 2 ms; return what came out at each time."""
    fault = KINDS[kind](items, parameters, Random(seed))
    return [fault([item], 2 * MS * k) for k, item in enumerate(sent)]


def test_off_lets_nothing_pass(stream):
    assert not any(through("off", *stream))


def test_stuck_repeats_the_first(stream):
    items, sent = stream
    assert through("stuck", items, sent) == [[sent[0]]] * len(sent)


def test_slow_passes_every_nth_unchanged(stream):
    items, sent = stream
    assert flat(through("slow", items, sent, every=4.0)) == sent[3::4]


def test_delayed_passes_all_in_order_and_late(stream):
    items, sent = stream
    out = through("delayed", items, sent, delay=0.006)
    assert out[:3] == [[], [], []]
    assert flat(out) == sent[:-3]


def test_intermittent_loses_some_by_seed(stream):
    items, sent = stream
    kept = flat(through("intermittent", items, sent))
    assert 0 < len(kept) < len(sent) and all(item in sent for item in kept)
    assert kept == flat(through("intermittent", items, sent))
    assert kept != flat(through("intermittent", items, sent, seed=2))


def test_a_burst_takes_that_many(stream):
    items, sent = stream
    assert not any(through("intermittent", items, sent, probability=1.0, burst=5.0))


def test_duplicated_passes_each_twice(stream):
    items, sent = stream
    assert through("duplicated", items, sent) == [[item, item] for item in sent]


def test_reordered_swaps_neighbours_and_loses_none(stream):
    items, sent = stream
    out = flat(through("reordered", items, sent))
    assert out[:4] == [sent[1], sent[0], sent[3], sent[2]]
    assert sorted(map(repr, out)) == sorted(map(repr, sent))


def test_garbage_keeps_the_form_and_changes_every_content(stream):
    items, sent = stream
    out = flat(through("garbage", items, sent))
    assert len(out) == len(sent) and all(type(a) is type(b) for a, b in zip(out, sent, strict=True))
    assert all(a != b for a, b in zip(out, sent, strict=True))
    if isinstance(sent[0], bytes):
        assert all(a[:8] == b[:8] for a, b in zip(out, sent, strict=True))


def test_wrong_says_something_else_in_good_form():
    (frame,) = through("wrong", *STREAMS["frames"])[0]
    assert next(iter_frames(frame)).can_id & ERROR_FLAG
    (frame,) = through("wrong", *STREAMS["drive"])[0]
    assert next(iter_frames(frame)).can_id == 0x182
    (record,) = through("wrong", *STREAMS["wrenches"], scale=-1.0, offset=2.0, code=4.0)[1]
    assert record.wrench[0] == pytest.approx(1.9) and record.status == 4
    (state,) = through("wrong", *STREAMS["pedal"], offset=2.0)[0]
    assert state.travel == 2.0
    assert through("wrong", *STREAMS["numbers"], scale=-1.0)[2] == [-0.2]


def test_sources_of_one_stream_do_not_mix():
    """A stuck bus repeats every drive's own frame."""
    frames = [pack_frame(0x181 + i % 2, bytes([i] * 8)) for i in range(6)]
    fault = KINDS["stuck"](BusFrames(), {}, Random(1))
    assert fault(frames, 0) == frames[:2] * 3


def test_held_repeats_the_first_and_looks_alive():
    items, sent = STREAMS["wrenches"]
    out = [record.wrench for record in flat(through("held", items, sent))]
    assert len(set(out)) == len(out), "a sensor that works never repeats itself to the bit"
    assert all(abs(wrench[0] - sent[0].wrench[0]) < 0.02 for wrench in out)
    items, sent = STREAMS["frames"]
    assert flat(through("held", items, sent)) == [sent[0]] * len(sent)


def test_chatter_is_false_and_true_in_turn():
    items, sent = STREAMS["numbers"]
    out = flat(through("chatter", items, sent, items=2.0, offset=5.0))
    assert out[:8] == [5.0, 5.0, *sent[2:4], 5.0, 5.0, *sent[6:8]]


def test_the_contacts_of_a_chattering_pedal_go_with_its_travel():
    pressed = PedalState(0.8, False, made=True, rest=False)
    off, on = flat(through("chatter", PedalStates(), [pressed] * 2, items=1.0, code=1.0))
    assert (off.travel, off.made, off.rest) == (0.0, False, True)
    assert on == pressed


def test_jitter_goes_to_and_fro():
    items, sent = STREAMS["numbers"]
    out = flat(through("jitter", items, sent, size=0.01, items=2.0))
    assert out[:5] == pytest.approx([0.01, 0.11, 0.19, 0.29, 0.41])


def test_exchanged_plugs_and_exchanged_poles():
    axes = (1.0, 2.0, 3.0, 4.0, 5.0)
    assert flat(through("miswired", Columns(), [axes], one=1.0, other=3.0)) == [[3.0, 2.0, 1.0, 4.0, 5.0]]
    assert flat(through("miswired", Columns(), [axes], one=2.0, other=2.0)) == [[1.0, -2.0, 3.0, 4.0, 5.0]]


@pytest.mark.parametrize("first", [0.0, 1.0])
def test_a_contradicted_source_says_two_things(first):
    items, sent = STREAMS["frames"]
    for item, pair in zip(sent, through("contradicted", items, sent, first=first), strict=True):
        mine, other = reversed(pair) if first else pair
        assert mine == item and other != item and items.key(other) == items.key(item)


def test_a_bias_is_a_force_and_a_torque_that_nobody_exerts():
    items, sent = STREAMS["wrenches"]
    record = flat(through("bias", items, sent, force=0.18, torque=0.03))[5]
    assert record.wrench == pytest.approx((0.5, 0.0, 0.18, 0.03, 0.0, 0.0)) and record.status == 0


def test_a_turned_sensor_reads_in_another_frame():
    """A quarter about y takes x to -z, and z to x."""
    along_x, along_z = WrenchRecord((1.0, 2.0, 0.0, 0.1, 0.0, 0.0), 1), WrenchRecord((0.0, 0.0, 3.0, 0.0, 0.2, 0.3), 2)
    first, second = flat(through("turn", WrenchRecords(), [along_x, along_z], angle=0.5 * math.pi))
    assert first.wrench == pytest.approx((0.0, 2.0, -1.0, 0.0, 0.0, -0.1), abs=1e-12)
    assert second.wrench == pytest.approx((3.0, 0.0, 0.0, 0.3, 0.2, 0.0), abs=1e-12)
