"""Compiled kinematics of the tilt linkage, an offset slider-crank (recorded-run contract, section 2).

Slider height x(theta) = r sin(theta) + sqrt(l^2 - (e - r cos(theta))^2); the actuator reads x(theta) - x(0).
Where no solution exists the functions return NaN.
"""

from __future__ import annotations

import math

from sher3_common.compiled import compiled_ieee

from sher3_kinematics.kernel.parameters import KernelParameters


@compiled_ieee
def slider_height(p: KernelParameters, q: float) -> float:
    """Return the slider's distance x [m] from the crank axis along its rail for the actuator position q [m]."""
    reach = p.offset - p.crank
    return q + p.zero_5 + math.sqrt(p.coupler * p.coupler - reach * reach)


@compiled_ieee
def tilt_sine_cosine(p: KernelParameters, q: float) -> tuple[float, float]:
    """Return sine and cosine of the tilt angle for the actuator position q [m], without trigonometry.

    The crank direction u = (sin, cos) satisfies v . u = K with v = (x, e) and K = (x^2 + e^2 + r^2 - l^2) / (2 r).
    """
    x, e = slider_height(p, q), p.offset
    square = x * x + e * e
    k = (square + p.crank * p.crank - p.coupler * p.coupler) / (2.0 * p.crank)
    s = math.sqrt(square - k * k)
    return (x * k - e * s) / square, (e * k + x * s) / square


@compiled_ieee
def tilt_angle(p: KernelParameters, q: float) -> float:
    """Return the tilt angle [rad] for the actuator position q [m]."""
    sine, cosine = tilt_sine_cosine(p, q)
    return math.atan2(sine, cosine)


@compiled_ieee
def tilt_slider(p: KernelParameters, angle: float) -> float:
    """Return the actuator position [m] for the tilt angle [rad]."""
    reach = p.offset - p.crank * math.cos(angle)
    x = p.crank * math.sin(angle) + math.sqrt(p.coupler * p.coupler - reach * reach)
    return x - slider_height(p, 0.0)


@compiled_ieee
def tilt_slope(p: KernelParameters, sine: float, cosine: float) -> float:
    """Return d slider / d angle [m/rad] for the sine and cosine of the tilt angle."""
    reach = p.offset - p.crank * cosine
    coupler_height = math.sqrt(p.coupler * p.coupler - reach * reach)
    return p.crank * cosine - reach * p.crank * sine / coupler_height


@compiled_ieee
def tilt_ratio(p: KernelParameters, angle: float) -> float:
    """Return d slider / d angle [m/rad] at the tilt angle [rad]; zero at a dead point."""
    return tilt_slope(p, math.sin(angle), math.cos(angle))
