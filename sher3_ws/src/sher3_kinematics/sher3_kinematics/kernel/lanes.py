"""Sine, cosine and arctangent without branches and without calls, so that a loop over poses becomes vector code.

The library's functions are calls, and a loop with a call computes one pose at a time. Coefficients: Cephes 2.8
(S. L. Moshier), `sin.c` and `atan.c`, double precision; errors are at most two units in the last place for angles up
to 1e5 rad.
"""

from __future__ import annotations

from sher3_common.compiled import compiled

ROUND = 6755399441055744.0
"""1.5 * 2^52: adding and subtracting it rounds a float below 2^51 to a whole number."""
QUARTERS = 0.6366197723675814
"""2 / pi."""
HALF_PI = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
"""pi / 2 in three parts, of which the first two have 33 bits."""
PI, PI_REST = 3.141592653589793, 1.2246467991473532e-16
TAN_PI_8 = 0.41421356237309503

compiled_inline = compiled(inline="always", error_model="numpy", nogil=True)


@compiled_inline
def sine_cosine(angle: float) -> tuple[float, float]:
    """Return sine and cosine of an angle [rad]."""
    k = (angle * QUARTERS + ROUND) - ROUND
    r = ((angle - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2]
    z = r * r
    s = 1.58962301576546568060e-10
    s = s * z - 2.50507477628578072866e-8
    s = s * z + 2.75573136213857245213e-6
    s = s * z - 1.98412698295895385996e-4
    s = s * z + 8.33333333332211858878e-3
    s = r + r * z * (s * z - 1.66666666666666307295e-1)
    c = -1.13585365213876817300e-11
    c = c * z + 2.08757008419747316778e-9
    c = c * z - 2.75573141792967388112e-7
    c = c * z + 2.48015872888517045348e-5
    c = c * z - 1.38888888888730564116e-3
    c = 1.0 - 0.5 * z + z * z * (c * z + 4.16666666666665929218e-2)
    half = ((0.5 * k - 0.25) + ROUND) - ROUND
    odd = k - 2.0 * half
    sign = 1.0 - 2.0 * (half - 2.0 * (((0.5 * half - 0.25) + ROUND) - ROUND))
    sine = s if odd == 0.0 else c
    cosine = c if odd == 0.0 else -s
    return sign * sine, sign * cosine


@compiled_inline
def direction_angle(y: float, x: float) -> float:
    """Return the angle [rad] of the direction (x, y), as `math.atan2` does; NaN for no direction."""
    far, near = (abs(y), abs(x)) if abs(y) > abs(x) else (abs(x), abs(y))
    t = near / far
    u = (t - 1.0) / (t + 1.0) if t > TAN_PI_8 else t
    z = u * u
    p = -8.750608600031904122785e-1
    p = p * z - 1.615753718733365076637e1
    p = p * z - 7.500855792314704667340e1
    p = p * z - 1.228866684490136173410e2
    p = p * z - 6.485021904942025371773e1
    q = z + 2.485846490142306297962e1
    q = q * z + 1.650270098316988542046e2
    q = q * z + 4.328810604912902668951e2
    q = q * z + 4.853903996359136964868e2
    q = q * z + 1.945506571482613964425e2
    a = u + (u * z * p / q + (0.25 * PI_REST if t > TAN_PI_8 else 0.0))
    a = 0.25 * PI + a if t > TAN_PI_8 else a
    a = 0.5 * PI - (a - 0.5 * PI_REST) if abs(y) > abs(x) else a
    a = PI - (a - PI_REST) if x < 0.0 else a
    return -a if y < 0.0 else a
