"""From motor to load and from both to their encoder readings, one axis, at the ticks (compiled).

Nothing here needs integration. Lead error, ripple and compliance are functions of motor position and load. Hysteresis
and play depend only on the path, which is monotone within a tick.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from sher3_common.compiled import compiled

from sher3_sim.axis import TWO_PI, bristle_step
from sher3_sim.found import POSITION, TRANSMISSION, VELOCITY, total


@compiled
def elastic_output(a: Any, motor: float, load: float) -> float:
    """Return the position [m or rad] behind lead error, ripple and compliance, before lost motion."""
    out = motor * (1.0 + a.lead_error) - a.compliance * load
    if a.ripple_amplitude != 0.0 or a.ripple_base_amplitude != 0.0:
        out += a.ripple_amplitude * math.sin(TWO_PI * a.ripple_periods * motor / a.lead + a.ripple_phase)
        out += a.ripple_base_amplitude * math.sin(TWO_PI * motor / a.lead + a.ripple_base_phase)
    return out


@compiled
def transmit(a: Any, s: Any, load: float, period: float) -> None:
    """Move the load with the motor: hysteresis is a bristle and backlash a play; both depend on the path so far."""
    base = elastic_output(a, s.position, load)
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
    motor = load
    for _ in range(30):
        motor += load + flank - elastic_output(a, motor, s.effort_load)
    s.position, s.load = motor, load
    s.base = elastic_output(a, motor, s.effort_load)
    s.velocity = 0.0


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
        if k == 0:
            s.base = elastic_output(a, motor[0], load[0])
            s.load = s.base - math.copysign(0.5 * a.backlash, load[0])
        transmit(a, s, load[k], period)
        out[k] = encode_load(a, s.load)
    return out
