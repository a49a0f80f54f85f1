"""No cause of a drawn machine is of no size, and none misses its own estimate."""

import pytest
from drawn_axes import drawn_axis, drawn_servo
from meaning import meaningless
from sher3_diagnosis import diagnose

SEEDS = (8101, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(8102, 8112)))


@pytest.mark.parametrize("draw", [drawn_axis, drawn_servo])
@pytest.mark.parametrize("seed", SEEDS)
def test_drawn(draw, seed):
    drawn = draw(seed)
    assert not meaningless(diagnose(drawn.machine, [drawn.run]).verdict)
