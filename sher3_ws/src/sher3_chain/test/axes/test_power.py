"""A verdict without a gap says which causes it would have seen; as much of one is seen."""

import re

from slides import columns, driven, effects, verdict_of


def test_no_gap_says_which_friction_would_have_shown():
    said = next(n for n in verdict_of(driven(seconds=8.0)).notes if "would have shown" in n)
    least = 1e-3 * float(re.search(r"Coulomb friction from (\S+) mN", said)[1])
    assert 0.0 < least < 1.0
    assert "coulomb_friction" in effects(verdict_of(driven(seconds=8.0, coulomb=least)))


def test_the_least_size_is_in_the_unit_of_the_force_that_was_recorded():
    amperes = {"signals": {**columns("position"), **columns("command", unit="A")}, "mass": "unknown"}
    verdict = verdict_of(driven(seconds=8.0), **amperes, command_law={"kind": "force"})
    said = next(n for n in verdict.notes if "would have shown" in n)
    assert re.search(r"Coulomb friction from \S+ mA,", said)
