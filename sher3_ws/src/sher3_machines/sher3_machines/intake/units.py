"""Units that columns come in, and how else they are spelled."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

UNITS: Mapping[str, float] = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "nm": 1e-9,
    "inch": 0.0254,
    "ft": 0.3048,
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": math.pi / 180.0,
    "arcmin": math.pi / 180.0 / 60.0,
    "arcsec": math.pi / 180.0 / 3600.0,
    "rev": 2.0 * math.pi,
    "m/s": 1.0,
    "cm/s": 1e-2,
    "mm/s": 1e-3,
    "rad/s": 1.0,
    "deg/s": math.pi / 180.0,
    "rev/s": 2.0 * math.pi,
    "rpm": math.pi / 30.0,
    "N": 1.0,
    "kN": 1e3,
    "mN": 1e-3,
    "gf": 9.80665e-3,
    "kgf": 9.80665,
    "lbf": 4.4482216152605,
    "N*m": 1.0,
    "mN*m": 1e-3,
    "Pa": 1.0,
    "kPa": 1e3,
    "bar": 1e5,
    "MPa": 1e6,
    "psi": 6894.757293168,
    "kg": 1.0,
    "V": 1.0,
    "mV": 1e-3,
    "A": 1.0,
    "mA": 1e-3,
    "%": 1.0,
    "1": 1.0,
    "count": 1.0,
    "degC": 1.0,
    "s": 1.0,
    "ms": 1e-3,
    "us": 1e-6,
    "ns": 1e-9,
    "min": 60.0,
    "h": 3600.0,
}
"""Unit -> factor to SI; a percentage stays one, of a rated value that nobody stated, and a gram is a weight."""
SHARE = re.compile(r"-?[01]\s*(:|\.\.+|to|bis)\s*\+?1")
"""A range that stands for a unit: `[-1:1]` is a share of the largest value."""
SPELLINGS = {
    "um": "µm μm micron microns",
    "mm": "millimeter millimetre",
    "m": "meter metre meters metres",
    "rad": "radian radians rads",
    "deg": "° degree degrees degs grad",
    "arcmin": "arcminute arcminutes amin",
    "arcsec": "arcsecond arcseconds asec as",
    "rev": "turn turns revolution revolutions revs rot",
    "deg/s": "°/s dps degrees/s deg/sec",
    "rev/s": "turns/s turn/s rps Hz",
    "rad/s": "rad/sec rads/s",
    "N": "newton newtons",
    "gf": "g gram grams gramforce",
    "lbf": "lb lbs pound pounds",
    "inch": "inches",
    "ft": "feet foot",
    "N*m": "Nm N·m N⋅m N.m N-m newton-meter",
    "mN*m": "mNm mN·m mN.m Nmm N·mm N.mm N*mm",
    "A": "amp amps ampere amperes Arms",
    "V": "volt volts Volt",
    "%": "pct percent prozent",
    "bar": "bars",
    "kPa": "kpa",
    "MPa": "Mpa mpa",
    "kg": "kilogram kilograms",
    "count": "counts cnt cnts inc incr increments ticks tick pulses steps ink inkremente schritte impulse",
    "degC": "°C C celsius Celsius",
    "s": "sec secs second seconds",
    "ms": "msec msecs millis milliseconds",
    "us": "µs μs usec micros microseconds",
    "min": "minute minutes",
    "h": "hour hours hr hrs",
    "ns": "nsec nanos nanoseconds nanosec",
    "1": "-",
}
"""Unit as descriptions have it -> how else headers spell it."""
READ_AS = {other: unit for unit, others in SPELLINGS.items() for other in others.split()}


def spelled(words: str) -> str:
    """Return a unit of a header as descriptions have it, a doubt (`amps?`) left out; unknown words as they are."""
    bare = words.strip().rstrip("?").rstrip()
    if SHARE.fullmatch(bare):
        return "1"
    unit = bare if bare in UNITS else READ_AS.get(bare, READ_AS.get(bare.lower(), bare))
    return {"N m": "N*m", "mN m": "mN*m"}.get(unit, unit)
