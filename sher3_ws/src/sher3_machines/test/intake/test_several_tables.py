"""Several tables in one sheet, and numbers with a sign in a field without one."""

import numpy as np
import pytest
from sher3_machines.intake.mending.fields import signed, unsigned_bits
from sher3_machines.intake.readers.rows import columns_of


def rows(text):
    return [line.split(",") for line in text.split()]


def test_tables_below_each_other_stand_side_by_side():
    found = columns_of(rows("mass,a mass,b 1,10 2,20 3,30 mass,c 1,5 2,6 3,7".replace("a mass,b 1", "a 0,1 1")), False)
    assert list(found) == ["mass", "a", "mass.2", "c"] and found["c"].tolist() == [5.0, 6.0, 7.0]
    same = columns_of(rows("mass,a 1,10 2,20 3,30 mass,c 1,5 2,6 3,7"), False)
    assert list(same) == ["mass", "a", "c"] and same["a"].tolist() == [10.0, 20.0, 30.0]


def test_a_header_that_comes_again_parts_nothing():
    found = columns_of(rows("t,q 0,1 1,2 2,3 t,q 3,4 4,5 5,6"), False)
    assert found["t"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]


def test_a_remark_is_no_header():
    found = columns_of(rows("t,q,note 0,1, 1,2, 2,3,late 3,4, 4,5,"), False)
    assert found["q"].tolist() == [1.0, 2.0, 3.0, 4.0, 5.0]


@pytest.mark.parametrize("bits", [16, 32])
def test_a_sign_that_a_field_took_is_given_back(bits):
    current = np.round(40.0 * np.sin(np.arange(300.0)))
    recorded = np.where(current < 0.0, current + 2.0**bits, current)
    assert unsigned_bits(recorded) == bits and signed(recorded, bits).tolist() == current.tolist()


@pytest.mark.parametrize(
    "x", [np.arange(65536.0), np.r_[np.zeros(9), np.full(9, 65535.0)], np.arange(255.0), np.r_[-1.0, 65535.0]]
)
def test_other_numbers_are_left_as_they_are(x):
    assert unsigned_bits(x) == 0
