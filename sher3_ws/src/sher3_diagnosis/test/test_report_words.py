"""Names and numbers as reports print them."""

import pytest
from sher3_diagnosis.words import listed, place, quantity, range_text, ratio_text, share, words


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.0123, "m", "12.3 mm"),
        (2.6e-6, "m", "2.6 µm"),
        (0.9996e-3, "m", "1 mm"),  # three digits of 999.6 µm
        (-1.06e-17, "m/s", "0 m/s"),  # what rounding leaves of zero
        (0.294, "N", "294 mN"),
        (1.5, "N*m/(rad/s)", "1.5 N·m/(rad/s)"),
        (0.012, "kg", "12 g"),
        (0.005, "1", "0.005"),
        (0.02, "1/K", "0.02 1/K"),
        (0.0, "m", "0 m"),
        (None, "m", "–"),
        (float("nan"), "m", "–"),
    ],
)
def test_quantities(value, unit, text):
    assert quantity(value, unit) == text


def test_intervals_say_why_there_is_none():
    assert range_text(1e-3, 2e-3, "m") == "1 mm … 2 mm"
    assert range_text(None, None, "m") == "too few runs"


@pytest.mark.parametrize(
    ("value", "text"), [(0.5, "50 %"), (0.996, "> 99 %"), (1.0, "100 %"), (None, "–"), (-0.1, "-10 %")]
)
def test_rounding_never_makes_a_part_the_whole(value, text):
    assert share(value) == text


def test_ratios():
    assert [ratio_text(x) for x in (2.94, 99.94, 100.0, 999.0, 1000.0)] == ["2.9", "99.9", "100", "999", "≫ 1000"]


def test_names():
    assert (words("coulomb_friction"), place("delta_1"), place("all")) == ("Coulomb friction", "delta 1", "all axes")
    assert listed(["a"]) == "a"
    assert listed(["a", "b", "c"]) == "a, b and c"
    assert listed(["a", "b", "c", "d"]) == "a, b and 2 more"
