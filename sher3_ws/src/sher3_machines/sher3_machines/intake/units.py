"""Units that columns come in, and how else they are spelled."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

KNOWN: Mapping[str, tuple[float, str]] = {
    "m": (1.0, "meter metre meters metres"),
    "cm": (1e-2, ""),
    "mm": (1e-3, "millimeter millimetre"),
    "um": (1e-6, "µm μm micron microns"),
    "nm": (1e-9, ""),
    "inch": (0.0254, "inches"),
    "ft": (0.3048, "feet foot"),
    "rad": (1.0, "radian radians rads"),
    "mrad": (1e-3, ""),
    "deg": (math.pi / 180.0, "° degree degrees degs grad"),
    "arcmin": (math.pi / 180.0 / 60.0, "arcminute arcminutes amin"),
    "arcsec": (math.pi / 180.0 / 3600.0, "arcsecond arcseconds asec as"),
    "rev": (2.0 * math.pi, "turn turns revolution revolutions revs rot"),
    "m/s": (1.0, ""),
    "cm/s": (1e-2, ""),
    "mm/s": (1e-3, ""),
    "rad/s": (1.0, "rad/sec rads/s"),
    "deg/s": (math.pi / 180.0, "°/s dps degrees/s deg/sec"),
    "rev/s": (2.0 * math.pi, "turns/s turn/s rps Hz"),
    "rpm": (math.pi / 30.0, "r/min rev/min U/min min-1 1/min erpm eRPM"),
    "N": (1.0, "newton newtons"),
    "kN": (1e3, ""),
    "mN": (1e-3, ""),
    "gf": (9.80665e-3, "g gram grams gramforce"),
    "kgf": (9.80665, ""),
    "lbf": (4.4482216152605, "lb lbs pound pounds"),
    "N*m": (1.0, "Nm N·m N⋅m N.m N-m newton-meter"),
    "mN*m": (1e-3, "mNm mN·m mN.m Nmm N·mm N.mm N*mm"),
    "Pa": (1.0, ""),
    "kPa": (1e3, "kpa"),
    "bar": (1e5, "bars"),
    "MPa": (1e6, "Mpa mpa"),
    "psi": (6894.757293168, ""),
    "kg": (1.0, "kilogram kilograms"),
    "V": (1.0, "volt volts Volt"),
    "mV": (1e-3, ""),
    "A": (1.0, "amp amps ampere amperes Arms"),
    "mA": (1e-3, ""),
    "%": (1.0, "pct percent prozent"),
    "1": (1.0, "-"),
    "count": (1.0, "counts cnt cnts inc incr increments ticks tick pulses steps ink inkremente schritte impulse"),
    "degC": (1.0, "°C C celsius Celsius"),
    "s": (1.0, "sec secs second seconds"),
    "ms": (1e-3, "msec msecs millis milliseconds"),
    "us": (1e-6, "µs μs usec micros microseconds"),
    "ns": (1e-9, "nsec nanos nanoseconds nanosec"),
    "min": (60.0, "minute minutes"),
    "h": (3600.0, "hour hours hr hrs"),
}
"""Unit -> factor to SI, and how else headers spell it.

A percentage stays one, of a rated value that nobody stated, and a gram is a weight.
"""
UNITS: Mapping[str, float] = {unit: factor for unit, (factor, _) in KNOWN.items()}
CAPITALS = 2
"""Letters up to which a unit in capitals is another one: `mN`, `MN`; `RPM` is rpm."""
READ_AS = {other: unit for unit, (_, others) in KNOWN.items() for other in others.split()}
READ_AS |= {unit: unit for unit in UNITS if len(unit) > CAPITALS}
SHARE = re.compile(r"-?[01]\s*(:|\.\.+|to|bis)\s*\+?1")
"""A range that stands for a unit: `[-1:1]` is a share of the largest value."""


def spelled(words: str) -> str:
    """Return a unit of a header as descriptions have it, a doubt (`amps?`) left out; unknown words as they are."""
    bare = words.strip().rstrip("?").rstrip()
    if SHARE.fullmatch(bare):
        return "1"
    unit = bare if bare in UNITS else READ_AS.get(bare, READ_AS.get(bare.lower(), bare))
    return {"N m": "N*m", "mN m": "mN*m"}.get(unit, unit)
