"""Second-order Butterworth low-pass with a declared cut-off in Hz.

The analogue filter becomes a discrete one by the bilinear transform with the cut-off pre-warped (Oppenheim and Schafer,
Discrete-Time Signal Processing, section 7.1), so the -3 dB point of the discrete filter is exactly at the cut-off. The
filter runs in direct form II transposed.
"""

from __future__ import annotations

import cmath
import math
from typing import NamedTuple

from sher3_common.compiled import compiled

SLOW = 1e-3
"""A frequency [Hz] so far below every cut-off that the phase lag is proportional to it."""


class LowPass(NamedTuple):
    """Coefficients of y = (b0 + b1 z^-1 + b2 z^-2) / (1 + a1 z^-1 + a2 z^-2) x, and the period of the samples [s]."""

    b0: float
    b1: float
    b2: float
    a1: float
    a2: float
    period: float

    def response(self, frequency: float) -> complex:
        """Return the complex gain at `frequency` [Hz]."""
        z = cmath.exp(-2j * math.pi * frequency * self.period)
        return (self.b0 + z * (self.b1 + z * self.b2)) / (1.0 + z * (self.a1 + z * self.a2))

    def phase_lag(self, frequency: float) -> float:
        """Return the phase lag at `frequency` [rad], positive for a lag."""
        return -cmath.phase(self.response(frequency))

    def delay(self) -> float:
        """Return the delay of slow signals [s], which is the group delay at zero frequency."""
        return self.phase_lag(SLOW) / (2.0 * math.pi * SLOW)


def design_low_pass(cutoff: float, period: float) -> LowPass:
    """Return the filter with its -3 dB point at `cutoff` [Hz], sampled every `period` [s]."""
    k = math.tan(math.pi * cutoff * period)
    norm = 1.0 / (1.0 + math.sqrt(2.0) * k + k * k)
    b0 = k * k * norm
    return LowPass(b0, 2.0 * b0, b0, 2.0 * (k * k - 1.0) * norm, (1.0 - math.sqrt(2.0) * k + k * k) * norm, period)


@compiled
def low_pass_step(c: LowPass, x: float, s1: float, s2: float) -> tuple[float, float, float]:
    """Filter the sample `x` with the states `s1`, `s2`; return the output and the two new states."""
    y = c.b0 * x + s1
    return y, c.b1 * x - c.a1 * y + s2, c.b2 * x - c.a2 * y
