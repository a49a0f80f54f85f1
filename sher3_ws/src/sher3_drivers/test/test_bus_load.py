"""The bus-load budget against the published frame lengths and against frames stuffed bit by bit."""

import pytest
from sher3_drivers.bus.load import channel_budget, check_budget, fd_frame_seconds, frame_bits
from sher3_drivers.errors import BusLoadError


@pytest.mark.parametrize(("n", "unstuffed", "worst"), [(0, 47, 55), (6, 95, 115), (8, 111, 135)])
def test_frame_lengths(n, unstuffed, worst):
    assert (frame_bits(n, stuffed=False), frame_bits(n)) == (unstuffed, worst)


def test_can_fd_figure_of_the_literature():
    """SYNC + 10 frames of 8 bytes at 1/5 Mbit/s and 1 kHz: 61 % of the bus."""
    assert fd_frame_seconds(0) + 10 * fd_frame_seconds(8) == pytest.approx(0.61e-3, abs=0.01e-3)


def stuff(bits):
    """Insert the complement after five equal bits, as the controller does."""
    out, run = [], 0
    for bit in bits:
        out.append(bit)
        run = run + 1 if len(out) > 1 and out[-2] == bit else 1
        if run == 5:
            out.append(1 - bit)
            run = 1
    return out


@pytest.mark.parametrize("n", [0, 6, 8])
def test_no_bit_pattern_needs_more_stuff_bits_than_the_bound(n):
    """The worst pattern, 11111 0000 1111 …, over the 34 + 8 n bits that are stuffed, reaches the bound exactly."""
    length = 34 + 8 * n
    worst = [1] * 5
    while len(worst) < length:
        worst += [1 - worst[-1]] * 4
    stuffed = len(stuff(worst[:length])) - length
    assert stuffed == frame_bits(n) - frame_bits(n, stuffed=False)


@pytest.mark.parametrize(
    ("drives", "rate", "load"), [(3, 500.0, 0.605), (2, 1000.0, 0.825), (5, 500.0, 0.990), (5, 1000.0, 1.980)]
)
def test_loads_of_the_design(drives, rate, load):
    assert channel_budget(drives, rate).load == pytest.approx(load)


def test_the_default_layouts_fit():
    assert all(
        budget.slack > 0 for budget in check_budget([3, 2], 500.0, 300.0) + check_budget([2, 2, 1], 1000.0, 300.0)
    )


@pytest.mark.parametrize(("layout", "rate"), [([5], 500.0), ([5], 1000.0), ([3, 2], 1000.0)])
def test_an_overloaded_layout_is_refused_with_its_budget(layout, rate):
    with pytest.raises(BusLoadError) as caught:
        check_budget(layout, rate)
    text = str(caught.value)
    assert "channel 0" in text and "limit 90 %" in text and "more channels" in text
