"""Features as text: what is read, refused, and in which unit its coefficient stands."""

import numpy as np
import pytest
from sher3_diagnosis.discover.feature import Factor, Feature, FormulaError, Quantity, parse

UNITS = {"velocity": "m/s", "position": "m", "load": "N", "delta_2.velocity": "m/s", "acceleration": "m/s^2"}


@pytest.mark.parametrize(
    "text", ["1", "square(velocity)", "itself(load) * sliding(position, 1e-05)", "size(delta_2.velocity)"]
)
def test_text_and_feature_are_the_same(text):
    assert str(parse(text)) == text


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("velocity", "no product"),
        ("square(velocity) +", "no product"),
        ("cube(velocity)", "no such law"),
        ("square(velocity, 2)", "other shape"),
        ("sliding(position)", "other shape"),
        ("sliding(position, -1)", "above zero"),
        ("sliding(position, x)", "no number"),
        ("itself(a) * itself(b) * itself(c) * itself(d)", "too many"),
        ("__import__('os').system('x')", "no product"),
    ],
)
def test_what_is_no_formula_is_refused(text, what):
    with pytest.raises(FormulaError, match=what):
        parse(text)


@pytest.mark.parametrize(
    ("text", "of", "unit"),
    [
        ("1", "N", "N"),
        ("signed_square(velocity)", "N", "N/(m/s)^2"),
        ("itself(velocity)", "m", "s"),
        ("itself(position)", "m", "1"),
        ("itself(load) * itself(velocity)", "N", "N/(N (m/s))"),
        ("sliding(position, 1e-05)", "N", "N"),
    ],
)
def test_units(text, of, unit):
    assert parse(text).unit(UNITS, of) == unit


def test_a_quantity_that_is_not_there_is_named():
    with pytest.raises(FormulaError, match="no such quantity"):
        Factor("itself", "mood").along({"velocity": Quantity(np.zeros(3), "m/s", "", "speed")}, 0.01)


def test_shapes_are_replaced_in_order():
    feature = parse("bump(position, 0.1, 0.2) * fading(velocity, 3)")
    assert feature.shape == (0.1, 0.2, 3.0)
    assert str(feature.reshaped((1.0, 2.0, 4.0))) == "bump(position, 1, 2) * fading(velocity, 4)"
    assert Feature().numbers == 1 and feature.numbers == 1 + 2 + 1 + 3
