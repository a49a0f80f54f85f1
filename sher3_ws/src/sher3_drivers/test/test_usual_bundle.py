"""The short way of a whole tick of reports is the long one, whatever is wrong with the bundle."""

from __future__ import annotations

import random

import pytest
from sher3_description import ACTUATORS, load_robot
from sher3_drivers.bus.frame import BUNDLED, FRAME_SIZE
from sher3_drivers.canopen.objects import CHECK_BASE, NODE_IDS, TPDO_BASES
from sher3_drivers.canopen.protection import check_of, count_after
from sher3_drivers.canopen.tpdo import CHECK_DATA, TPDO1_DATA, TPDO2_DATA, TpdoCollector
from sher3_drivers.units import AxisScale

SCALES = [AxisScale.from_actuator(actuator) for actuator in load_robot().actuators]
NODES = [NODE_IDS[name] for name in ACTUATORS]
CHANNELS = [0, 1, 0, 1, 1]


def bundle_of(dice, counter, orders=(0, 2, 1, 3, 4)):
    """Return the frames of a tick, drive by drive."""
    frames = []
    for axis in orders:
        first = TPDO1_DATA.pack(dice.randint(-(2**31), 2**31 - 1), 0x1237, dice.randint(-1000, 1000))
        second = TPDO2_DATA.pack(dice.randint(-(2**31), 2**31 - 1), dice.randint(-1000, 1000))
        check = CHECK_DATA.pack(check_of(first + second, NODES[axis], counter))
        for base, data in zip((*TPDO_BASES, CHECK_BASE), (first, second, check), strict=True):
            frames.append(BUNDLED.pack(base + NODES[axis], len(data), CHANNELS[axis], data))
    return frames


def harmed(dice, frames):
    """Return the frames of a bundle, most often as they are."""
    kind, frames = dice.random(), list(frames)
    at = dice.randrange(len(frames))
    if kind < 0.1:
        del frames[at]
    elif kind < 0.2:
        frames.insert(dice.randrange(len(frames)), frames[at])
    elif kind < 0.3:
        dice.shuffle(frames)
    elif kind < 0.5:
        harmed_byte = bytearray(frames[at])
        harmed_byte[dice.randrange(FRAME_SIZE)] ^= 1 << dice.randrange(8)
        frames[at] = bytes(harmed_byte)
    return frames


def test_the_short_way_through_a_bundle_is_the_long_one():
    dice, counter, whole = random.Random(3), 0, 0
    short = TpdoCollector(SCALES, NODES, 1e-3, CHANNELS, protected=True)
    long = TpdoCollector(SCALES, NODES, 1e-3, CHANNELS, protected=True)
    for _ in range(5000):
        counter = count_after(counter)
        frames = harmed(dice, bundle_of(dice, counter if dice.random() < 0.95 else 7))
        pieces = [b"".join(frames)] + ([frames[0]] if dice.random() < 0.1 else [])
        for collector in (short, long):
            collector.begin(counter)
        others = [short.take(piece) for piece in pieces]
        # Cut in two, a bundle is none of every tick, and goes the long way.
        cuts = [[long.take(piece[:FRAME_SIZE]), long.take(piece[FRAME_SIZE:])] for piece in pieces]
        assert [list(part) for part in others] == [a + b for a, b in cuts]
        assert short.end() == long.end()
        hidden = {"_usual"}
        assert {k: v for k, v in vars(short).items() if k not in hidden} == {
            k: v for k, v in vars(long).items() if k not in hidden
        }
        if short.has(short.all_mask):
            whole += 1
            assert short.feedback(counter) == long.feedback(counter)
    assert 2000 < whole < 4500


def test_every_number_is_read_where_it_stands():
    collector = TpdoCollector(SCALES, NODES, 1e-3, CHANNELS, protected=True)
    collector.begin(9)
    frames = bundle_of(random.Random(1), 9)
    assert collector.take(b"".join(frames)) == [] and collector.has(collector.all_mask)
    said, feedback = {}, collector.feedback(9)
    for can_id, _, _, data in map(BUNDLED.unpack, frames):
        said[can_id] = data
    for axis, (node, scale) in enumerate(zip(NODES, SCALES, strict=True)):
        load, word, torque = TPDO1_DATA.unpack(said[TPDO_BASES[0] + node])
        motor, demand = TPDO2_DATA.unpack(said[TPDO_BASES[1] + node])
        assert collector.statuswords[axis] == word
        assert feedback.load_position[axis] == load * scale.load_encoder
        assert feedback.effort[axis] == torque * scale.effort
        assert feedback.motor_position[axis] == motor * scale.motor_encoder
        assert feedback.velocity_demand[axis] == demand * scale.velocity


@pytest.mark.parametrize("protected", [False, True])
@pytest.mark.parametrize("channels", [None, CHANNELS])
def test_no_frames_at_all_bring_nothing(protected, channels):
    collector = TpdoCollector(SCALES, NODES, 0.002, channels, protected)
    assert collector.take(b"") == []
    assert not collector.has(collector.positions_mask) and not collector.has(collector.all_mask)
