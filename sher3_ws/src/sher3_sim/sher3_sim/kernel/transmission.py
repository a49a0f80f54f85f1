"""From motor to load and from both to their encoder readings, one axis, at the ticks (compiled).

Nothing here needs integration. Lead error and ripple are functions of motor position. A compliance follows the load and
what its mass needs, held over a tick. Hysteresis and play depend only on the path, which is monotone within a tick.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from sher3_common.compiled import compiled
from sher3_common.laws import swing_map

from sher3_sim.found import POSITION, TRANSMISSION, VELOCITY, total
from sher3_sim.kernel.axis import TWO_PI, bristle_step


@compiled
def geared(a: Any, motor: float) -> float:
    """Return the position [m or rad] behind lead error and ripple."""
    out = motor * (1.0 + a.lead_error)
    if a.ripple_amplitude != 0.0 or a.ripple_base_amplitude != 0.0:
        out += a.ripple_amplitude * math.sin(TWO_PI * a.ripple_periods * motor / a.lead + a.ripple_phase)
        out += a.ripple_base_amplitude * math.sin(TWO_PI * motor / a.lead + a.ripple_base_phase)
    return out


@compiled
def give_way(a: Any, s: Any, load: float, period: float) -> float:
    """Advance the spring of the transmission by a tick and return how far it gives [m or rad].

    It carries weight and contact, and what the load's mass needs to follow the motor; on a slow spring that mass
    swings: d'' + 2 z w d' + w^2 d = w^2 compliance force.
    """
    wanted = a.compliance * (load + a.load_mass * (s.velocity - s.pace) / period)
    s.pace = s.velocity
    if a.swing_frequency == 0.0:
        s.given = wanted
        return wanted
    a11, a12, a21, a22 = swing_map(a.swing_frequency, a.swing_damping, period)
    off = s.given - wanted
    s.given, s.giving = wanted + a11 * off + a12 * s.giving, a21 * off + a22 * s.giving
    return s.given


@compiled
def felt(a: Any, s: Any, load: float, period: float) -> float:
    """Return the force [N or N m] that the motor feels of its load: where that swings, of the spring in mid-tick."""
    if a.swing_frequency == 0.0 or a.compliance == 0.0:
        return load
    return (s.given + 0.5 * period * s.giving) / a.compliance


@compiled
def transmit(a: Any, s: Any, load: float, period: float) -> None:
    """Move the load with the motor: hysteresis is a bristle and backlash a play; both depend on the path so far."""
    base = geared(a, s.position) - give_way(a, s, load, period)
    if a.found_any:
        s.found_inputs[POSITION], s.found_inputs[VELOCITY] = s.position, s.velocity
        base += total(a.found, TRANSMISSION, s.found_inputs, s.found_last, s.found_memory, period)
    moved = base - s.base
    s.base = base
    if a.hysteresis > 0.0:
        s.hysteresis = bristle_step(s.hysteresis, moved, a.hysteresis_displacement)
        base -= 0.5 * a.hysteresis * s.hysteresis / a.hysteresis_displacement
    if a.backlash > 0.0:
        half = 0.5 * a.backlash
        s.load = min(max(s.load, base - half), base + half)
    else:
        s.load = base


@compiled
def encode_load(a: Any, load: float) -> float:
    """Return the load encoder's reading before rounding: scale, eccentricity, zero."""
    reading = load * (1.0 + a.encoder_scale) + a.encoder_offset
    if a.eccentricity != 0.0:
        reading += a.eccentricity * math.sin(TWO_PI * load / a.lead + a.eccentricity_phase)
    return reading


@compiled
def to_count(value: float, count: float) -> float:
    """Round to the nearest multiple of a count."""
    return math.floor(value / count + 0.5) * count


@compiled
def place(a: Any, s: Any, reading: float) -> None:
    """Put the axis at rest where its load encoder reads `reading`, the transmission resting on the loaded flank.

    Contract, section 3: a run starts at rest at the first set-point. Fixed-point iteration; the corrections are small.
    """
    load = reading
    for _ in range(30):
        load += reading - encode_load(a, load)
    flank = 0.0
    if a.backlash > 0.0:
        flank = math.copysign(0.5 * a.backlash, s.effort_load)
    motor, give = load, a.compliance * s.effort_load
    for _ in range(30):
        motor += load + flank + give - geared(a, motor)
    s.position, s.load = motor, load
    s.base = geared(a, motor) - give
    s.velocity, s.pace, s.given, s.giving = 0.0, 0.0, give, 0.0


@compiled
def follow(a: Any, s: Any, motor: Any, load: Any, period: float) -> Any:
    """Return load positions (n,) for a recorded motor path: the transmission stage alone, given its input.

    Args:
        a: AXIS record.
        s: AXIS_STATE record, fresh; changed in place.
        motor: Motor positions (n,) [m or rad].
        load: Load on the axis, gravity less contact (n,) [N or N m].
        period: Time between two positions [s].
    """
    out = np.empty(len(motor))
    for k in range(len(motor)):
        s.position = motor[k]
        s.velocity = (motor[k] - motor[k - 1]) / period if k else 0.0
        if k == 0:
            s.given = a.compliance * load[0]
            s.base = geared(a, motor[0]) - s.given
            s.load = s.base - math.copysign(0.5 * a.backlash, load[0])
        transmit(a, s, load[k], period)
        out[k] = encode_load(a, s.load)
    return out
