"""Names and numbers as every report and every command prints them."""

from __future__ import annotations

import math

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))
_PLAIN = frozenset({"1", "", "1/K", "1/s", "%"})
"""Units that take no prefix."""
_COUNTED = frozenset({"%", "count", "eu"})
"""Units that take no prefix in a product either: percent of a rated force, counts, units of the effort as recorded."""
ROUNDS_UP = 0.9995
"""Share of a prefix from which a number of three digits is printed with it: 999.5 µm reads 1 mm."""
NOTHING = 1e-14
"""Size below which a number is what rounding leaves of zero; it is printed as 0."""
DIGITS = (3, 4, 5, 6)
"""Digits of the ends of an interval that are tried until the ends differ."""
WHOLE = 999.5
"""Number from which three digits would need a power of ten."""
TENTHS = 100.0
"""Gap over floor from which its tenths are not told."""
BEYOND = 1000.0
"""Gap over floor that is only called very large: the floor's own spread makes its digits meaningless."""


def words(identifier: str) -> str:
    """Return an effect, family or stage id in words: `coulomb_friction` -> `Coulomb friction`."""
    text = identifier.replace("_", " ")
    return text[:1].upper() + text[1:]


NAMES_OF_PEOPLE = ("coulomb", "stribeck")
"""First words of effects that keep their capital inside a sentence."""


def lower(identifier: str) -> str:
    """Return an id in words as they stand inside a sentence."""
    text = words(identifier)
    return text if text.lower().startswith(NAMES_OF_PEOPLE) else text[:1].lower() + text[1:]


def place(site: str) -> str:
    """Return a place of a machine in words: `delta_1` -> `delta 1`; `all` is every axis."""
    return "all axes" if site == "all" else site.replace("_", " ")


def quantity(value: float | None, unit: str, digits: int = 3) -> str:
    """Return a number with some digits, an SI prefix and its unit; a dash for None and for what is not finite."""
    if value is None or not math.isfinite(value):
        return "–"
    shown = unit.replace("*", "·")
    if unit in _PLAIN or unit.split("/", 1)[0] in _COUNTED:
        return f"{value:.{digits}g}" + ("" if unit in ("1", "") else f" {shown}")
    if unit.startswith("kg"):
        value, shown = value * 1e3, shown[1:]
    size = abs(value)
    if size < NOTHING:
        return f"0 {shown}"
    scale, prefix = next(((s, p) for s, p in _PREFIXES if size >= ROUNDS_UP * s), (1.0, ""))
    number = value / scale
    text = f"{number:.0f}" if abs(number) >= WHOLE else f"{number:.{digits}g}"
    return f"{text} {prefix}{shown}"


def rounded(value: float, unit: str) -> str:
    """Return a number of which two digits are known, with an SI prefix and its unit."""
    return quantity(float(f"{value:.2g}"), unit)


def range_text(low: float | None, high: float | None, unit: str) -> str:
    """Return an interval with digits enough to tell its ends apart, or why there is none."""
    if low is None or high is None:
        return "too few runs"
    ends = [(quantity(low, unit, digits), quantity(high, unit, digits)) for digits in DIGITS]
    first, last = next((pair for pair in ends if pair[0] != pair[1]), ends[0])
    return f"{first} … {last}"


def share(value: float | None) -> str:
    """Return a closure as a percentage; rounding never makes a part look like the whole."""
    if value is None:
        return "–"
    text = f"{100 * value:.0f} %"
    return "> 99 %" if text == "100 %" and value < 1.0 else text


def ratio_text(ratio: float) -> str:
    """Return a gap over its floor."""
    if ratio >= BEYOND:
        return "≫ 1000"
    return f"{ratio:.1f}" if ratio < TENTHS else f"{ratio:.0f}"


def listed(names: list[str], shown: int = 3) -> str:
    """Return names as a list in a sentence: `a`, `a and b`, `a, b and 2 more`."""
    if len(names) > shown:
        names = [*names[: shown - 1], f"{len(names) - shown + 1} more"]
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
