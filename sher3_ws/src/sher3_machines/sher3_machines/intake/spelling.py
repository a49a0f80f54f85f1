"""How headers are spelled: tables, columns and units."""

from __future__ import annotations

import re

from sher3_machines.intake.fields import UNITS

SHARE = re.compile(r"-?[01]\s*(:|\.\.+|to|bis)\s*\+?1")
"""A range that stands for a unit: `[-1:1]` is a share of the largest value."""
PARTING = re.compile(r"/(?![^\[(]*[\])])")
"""The stroke between a table and its column."""
SPELLINGS = {
    "um": "µm μm micron microns",
    "mm": "millimeter millimetre",
    "m": "meter metre meters metres",
    "rad": "radian radians rads",
    "deg": "° degree degrees degs grad",
    "arcmin": "arcminute arcminutes amin",
    "arcsec": "arcsecond arcseconds asec as",
    "rev": "turn turns revolution revolutions revs rot",
    "N": "newton newtons",
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


def table_of(name: str) -> str:
    """Return the table a column lies in, empty for none; a stroke in the unit (`v [rad/s]`) parts nothing."""
    return name[: max(len(name) - len(bare(name)) - 1, 0)]


def bare(name: str) -> str:
    """Return a column's name without its table."""
    return PARTING.split(name)[-1]


def spelled(words: str) -> str:
    """Return a unit of a header as descriptions have it, a doubt (`amps?`) left out; unknown words as they are."""
    bare = words.strip().rstrip("?").rstrip()
    if SHARE.fullmatch(bare):
        return "1"
    unit = bare if bare in UNITS else READ_AS.get(bare, READ_AS.get(bare.lower(), bare))
    return {"N m": "N*m", "mN m": "mN*m"}.get(unit, unit)
