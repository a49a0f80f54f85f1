"""Several tables in one sheet, and numbers with a sign in a field without one."""

import numpy as np
import pytest
from sher3_machines.intake.mending.fields import signed
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


CURRENT = np.round(40.0 * np.sin(np.arange(300.0)))
CARRIES = {
    "16 bits": np.where(CURRENT < 0.0, CURRENT + 2.0**16, CURRENT),
    "32 bits": np.where(CURRENT < 0.0, CURRENT + 2.0**32, CURRENT),
    "bit 15 is the sign": np.where(CURRENT < 0.0, 2.0**15 - CURRENT, CURRENT),
    "bit 10 is the sign": np.where(CURRENT < 0.0, 2.0**10 - CURRENT, CURRENT),
}


@pytest.mark.parametrize("form", CARRIES)
def test_a_sign_that_a_field_took_is_given_back(form):
    found, said = signed(CARRIES[form])
    assert found.tolist() == CURRENT.tolist() and "for -1" in said


@pytest.mark.parametrize("most", [200.0, 500.0, 1000.0])
def test_a_sign_in_a_bit_of_its_own_is_found_at_ten_readings_a_second(most):
    """Loads of a servo on a bus: up to 1000, with 1024 for the sign; some readings lie between two of them."""
    load = np.round(most * np.sin(np.arange(150.0) / 2.0) * np.sin(np.arange(150.0) / 29.0))
    found, _ = signed(np.r_[np.nan, np.where(load < 0.0, 1024.0 - load, load)])
    assert found[1:].tolist() == load.tolist()


OTHERS = {
    "ramp": np.arange(65536.0),
    "switch": np.r_[np.zeros(9), np.full(9, 65535.0)],
    "duty": np.arange(255.0),
    "signed already": np.r_[-1.0, 65535.0],
    "speed through 1024": np.round(1024.0 + 900.0 * np.sin(np.arange(500.0) / 20.0)),
    "noise": np.round(np.random.default_rng(3).uniform(0.0, 1500.0, 500)),
    "steps": np.repeat([0.0, 1030.0, 0.0, 1500.0, 0.0, 1200.0, 0.0, 1600.0], 9),
}


@pytest.mark.parametrize("name", OTHERS)
def test_other_numbers_are_left_as_they_are(name):
    found, said = signed(OTHERS[name])
    assert said == "" and found is OTHERS[name]
