"""What a foot can do and what it cannot: contacts, chatter, presses without end."""

import math

import pytest
from sher3_drivers.pedal.device import PedalState, wired
from sher3_drivers.pedal.plausible import FOOT, PedalLimits, PedalWatch

MS = 1_000_000
PRESSED, RELEASED = wired(PedalState(0.8, False)), wired(PedalState(0.0, False))


class Foot:
    """A watch that hears a state every 2 ms."""

    def __init__(self, limits=FOOT):
        self.watch, self.now = PedalWatch(limits), 10**9

    def hold(self, state, milliseconds):
        for _ in range(max(1, milliseconds // 2)):
            self.now += 2 * MS
            heard = self.watch.judge(state, self.now)
        return heard


def test_a_foot_passes():
    foot = Foot()
    assert foot.hold(RELEASED, 100) == RELEASED and foot.hold(PRESSED, 5000) == PRESSED
    assert foot.hold(RELEASED, 2) == RELEASED and foot.watch.fault is None


@pytest.mark.parametrize(
    ("travel", "made", "rest"),
    [(0.8, True, True), (0.8, False, False), (0.8, False, True), (0.8, None, None), (0.0, True, True),
     (0.0, True, False), (0.3, True, True)],
)  # fmt: skip
def test_what_contradicts_itself_is_released_at_once_and_lost_after_the_time_of_a_slow_foot(travel, made, rest):
    foot = Foot()
    foot.hold(PRESSED, 100)
    state = PedalState(travel, False, made, rest)
    assert foot.hold(state, 2).travel == 0.0
    assert foot.hold(state, 48).travel == 0.0
    lost = foot.hold(state, 4)
    assert math.isnan(lost.travel) and lost.emergency_stop and "contra" in foot.watch.fault
    assert foot.hold(RELEASED, 2) == RELEASED and foot.watch.fault is None


def test_a_press_counts_only_while_both_contacts_say_so():
    foot = Foot()
    foot.hold(RELEASED, 10)
    assert foot.hold(PedalState(0.8, False, False, False), 20).travel == 0.0
    assert foot.hold(PRESSED, 2).travel == 0.8


@pytest.mark.parametrize("half", [10, 20, 50])
def test_chatter_is_no_foot_and_is_barred_until_the_pedal_rested(half):
    """Half periods of 10 to 50 ms: 50 to 10 Hz; noticed at the ninth press."""
    foot = Foot()
    for k in range(30):
        heard = foot.hold(PRESSED if k % 2 else RELEASED, half)
        if math.isnan(heard.travel):
            break
    assert k <= 2 * FOOT.presses + 2 and "times in 1 s" in foot.watch.fault and not heard.emergency_stop
    assert math.isnan(foot.hold(RELEASED, 490).travel)
    foot.hold(RELEASED, 1000)
    assert foot.hold(PRESSED, 10) == PRESSED


def test_five_taps_a_second_are_a_foot():
    foot = Foot()
    assert all(foot.hold(PRESSED, 100).travel and foot.hold(RELEASED, 100).travel == 0.0 for _ in range(25))


def test_a_press_without_end_ends():
    foot = Foot(PedalLimits(longest=2.0))
    assert foot.hold(PRESSED, 2000).travel == 0.8
    assert math.isnan(foot.hold(PRESSED, 4).travel) and math.isnan(foot.hold(PRESSED, 1000).travel)
    foot.hold(RELEASED, 600)
    assert foot.hold(PRESSED, 10) == PRESSED


def test_the_emergency_stop_is_heard_whatever_the_pedal_does():
    foot = Foot(PedalLimits(longest=0.1))
    foot.hold(PRESSED, 200)
    assert foot.hold(PRESSED._replace(emergency_stop=True), 2).emergency_stop
