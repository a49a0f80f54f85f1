"""Any bytes on the bus: neither side crashes and nothing moves that was not enabled."""

import itertools

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sher3_description import load_robot
from sher3_drivers.bus import open_link
from sher3_drivers.frame import ERROR_FLAG, Frame, pack_frames
from sher3_drivers.lockstep_rig import LockstepRig
from sher3_drivers.settings import default_settings

ROBOT = load_robot()
SLOW = [0.001, -0.002, 0.003, 0.1, -0.004]
_numbers = itertools.count()

services = [0x000, 0x080, 0x180, 0x200, 0x280, 0x300, 0x380, 0x580, 0x600, 0x700]
ids = st.one_of(
    st.builds(lambda base, node: base + node, st.sampled_from(services), st.integers(0, 6)),
    st.integers(0, 0x7FF),
    st.integers(ERROR_FLAG, ERROR_FLAG + 0x1FF),
)
bursts = st.lists(st.builds(Frame, ids, st.binary(max_size=8)), max_size=30).map(pack_frames)
relaxed = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))


def make_rig():
    prefix = f"fuzz{next(_numbers)}"
    rig = LockstepRig(ROBOT, default_settings(), lambda i: open_link(f"virtual:{prefix}-{i}"))
    return rig, [open_link(f"virtual:{prefix}-{i}") for i in range(2)]


@pytest.fixture(scope="module")
def disabled():
    rig, intruders = make_rig()
    rig.driver.configure()
    yield rig, intruders
    rig.close()


def harmless(frames):
    """Whether the burst has nothing a drive must obey from anyone: no RPDO and no SDO request."""
    ids = [int.from_bytes(frames[k : k + 4], "little") & 0x780 for k in range(0, len(frames), 16)]
    return not {0x200, 0x300, 0x600} & set(ids)


@relaxed
@given(bursts.filter(harmless), st.integers(0, 1))
def test_a_disabled_robot_does_not_move_and_both_sides_live(disabled, frames, channel):
    rig, intruders = disabled
    intruders[channel].send_frames(frames)
    for _ in range(3):
        rig.tick(SLOW)
    assert rig.plant.position == [0.0] * 5


@relaxed
@given(bursts, st.integers(0, 1))
def test_no_frame_crashes_a_side(disabled, frames, channel):
    rig, intruders = disabled
    intruders[channel].send_frames(frames)
    for _ in range(2):
        rig.tick()


@pytest.mark.parametrize("seed", range(20))
def test_an_enabled_robot_under_garbage_stays_within_its_limits(seed):
    """Whatever the garbage does, no axis ever moves faster than its velocity limit, and a stop is a stop."""
    import random

    rng = random.Random(seed)
    rig, intruders = make_rig()
    rig.enable()
    limits = [a.limits.velocity * 1.01 * rig.settings.period for a in ROBOT.actuators]
    for _ in range(60):
        count = rng.randrange(4)
        frames = [Frame(rng.choice(services) + rng.randrange(7), rng.randbytes(rng.randrange(9))) for _ in range(count)]
        intruders[rng.randrange(2)].send_frames(pack_frames(frames))
        before = list(rig.plant.position)
        rig.tick(SLOW)
        steps = [abs(after - b) for after, b in zip(rig.plant.position, before, strict=True)]
        # A SYNC of an intruder makes the plant step once more.
        assert all(step <= 5 * limit for step, limit in zip(steps, limits, strict=True))
    if rig.driver.stop.reason is not None:
        assert not rig.driver.enabled
    rig.close()
