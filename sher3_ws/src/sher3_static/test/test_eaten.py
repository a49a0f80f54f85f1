"""Tables whose readings scatter by as much as they should follow: no gap is no finding there."""

import numpy as np
import pytest
from sher3_diagnosis import diagnose
from sher3_static.cell.kind import KIND

DESCRIBED = KIND.description.model_validate(
    {
        "kind": "load_cell",
        "name": "cell",
        "applied": {"column": "n", "unit": "N"},
        "reading": {"column": "r", "unit": "N"},
    }
)


def found(noise, seed=1):
    """A cell of 10 N without an error that reads with this noise, N."""
    force = np.tile(np.concatenate([np.arange(0.0, 10.1, 1.0), np.arange(9.0, 0.0, -1.0)]), 4)
    data = {"n": force, "r": force + np.random.default_rng(seed).normal(0.0, noise, len(force))}
    return diagnose(KIND.machine(DESCRIBED), [KIND.read("a", data, DESCRIBED)])


@pytest.mark.parametrize("seed", range(5))
def test_no_gap_is_a_finding_where_the_readings_follow(seed):
    done = found(0.1, seed)
    assert done.verdict.status == "no_gap"
    assert not done.machine.unjudgeable(done.findings[0])


@pytest.mark.parametrize("seed", range(5))
def test_where_the_readings_scatter_nothing_is_said(seed):
    """1.5 N of noise are half of the 3 N by which the force differs: an error of 10 % would hide in it."""
    done = found(1.5, seed)
    (why,) = done.machine.unjudgeable(done.findings[0]).values()
    assert "cannot be judged: readings of cell scatter by 0." in why and "better reference" in why
    assert done.verdict.status == "outside_library" and done.verdict.unexplained.signature == why
