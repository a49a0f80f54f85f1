"""What a page says that a command prints, compared with what it prints.

Words are compared exactly, numbers within a relative tolerance: that of the fence (```` ```text within 5% ````) or
`TOLERANCE`. `...` stands for any text within a line and, on a line of its own, for any lines. What is printed before
the first line shown and after the last one is not compared.
"""

from __future__ import annotations

import re

from documentation.pages import Block

TOLERANCE = 0.01
"""Relative tolerance of a number where the fence states none; a number without decimals is exact below a hundred."""
NUMBER = r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
_PART = re.compile(rf"({NUMBER}|\.\.\.|\s+)")


def tolerance(block: Block) -> float:
    """Return the relative tolerance of a block of expected output."""
    stated = re.fullmatch(r"within (\d+(?:\.\d+)?)%", block.tag)
    assert stated or not block.tag, f"{block.page}:{block.line}: a fence of output is `text` or `text within 5%`"
    return float(stated[1]) / 100 if stated else TOLERANCE


def unlike(expected: str, printed: str, within: float = TOLERANCE) -> str:
    """Return the first expected line that is not printed where it should be, with what stands there; empty if none."""
    wanted, lines = expected.splitlines(), printed.splitlines()
    at, anywhere = 0, True
    for line in wanted:
        if line.strip() == "...":
            anywhere = True
            continue
        places = range(at, len(lines)) if anywhere else range(at, min(at + 1, len(lines)))
        found = next((place for place in places if same(line, lines[place], within)), None)
        if found is None:
            there = "anywhere behind" if anywhere else "but"
            return f"expected {line!r}, {there} {lines[at] if at < len(lines) else 'the end'!r}"
        at, anywhere = found + 1, False
    return ""


def same(expected: str, printed: str, within: float) -> bool:
    """Return whether a printed line is the expected one: words exactly, numbers within the tolerance."""
    parts = [part for part in _PART.split(expected.strip()) if part]
    match = re.fullmatch("".join(map(_pattern, parts)), printed.strip())
    numbers = [part for part in parts if re.fullmatch(NUMBER, part)]
    return match is not None and all(map(lambda a, b: _near(a, b, within), numbers, match.groups()))


def _pattern(part: str) -> str:
    if part == "...":
        return ".*?"
    if part.isspace():
        return r"\s+"
    return f"({NUMBER})" if re.fullmatch(NUMBER, part) else re.escape(part)


def _near(expected: str, printed: str, within: float) -> bool:
    """Return whether two numbers agree within the tolerance, or to half of the last decimal that is shown."""
    decimals = len(expected.partition("e")[0].partition(".")[2])
    last = 0.5 * 10.0**-decimals if decimals and "e" not in expected else 0.0
    return abs(float(expected) - float(printed)) <= max(within * abs(float(expected)), last) * (1 + 1e-9)
