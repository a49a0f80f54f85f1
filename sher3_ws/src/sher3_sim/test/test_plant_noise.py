import numpy as np
from numba import njit
from sher3_sim.kernel.noise import normal, uniform


@njit
def draws(seed, stream, n):
    out = np.empty((2, n))
    for i in range(n):
        out[0, i], out[1, i] = normal(seed, stream, i), uniform(seed, stream, i)
    return out


def test_moments_and_independence():
    x, u = draws(5, 3, 200_000)
    assert abs(x.mean()) < 0.01 and abs(x.std() - 1) < 0.01 and abs((x**4).mean() - 3) < 0.1
    assert abs(u.mean() - 0.5) < 0.003 and u.min() > 0 and u.max() < 1
    y = draws(5, 4, 200_000)[0]
    z = draws(6, 3, 200_000)[0]
    for other in (y, z, np.roll(x, 1)):
        assert abs(np.corrcoef(x, other)[0, 1]) < 0.01


def test_pure_function_of_its_arguments():
    assert np.array_equal(draws(1, 2, 10), draws(1, 2, 20)[:, :10])
