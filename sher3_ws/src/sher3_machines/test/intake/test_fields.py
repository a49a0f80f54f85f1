"""Units and clocks of descriptions."""

import numpy as np
import pytest
from pydantic import ValidationError
from sher3_machines import MachineError
from sher3_machines.intake.columns import pick, stamps_of
from sher3_machines.intake.fields import Clock, Column, Description


def test_a_factor_comes_on_top_of_the_unit():
    """200 mA at 0.5 N m per A are 0.1 N m."""
    assert Column(column="i", unit="mA", factor=0.5).scale * 200.0 == pytest.approx(0.1)
    assert Column(column="q", unit="rpm").scale == pytest.approx(np.pi / 30.0)


def test_an_unknown_unit_is_named():
    with pytest.raises(ValidationError, match="'furlong' is not known"):
        Column(column="q", unit="furlong")


@pytest.mark.parametrize("both", [{}, {"column": "t", "rate": 100.0}])
def test_a_clock_has_stamps_or_a_rate(both):
    with pytest.raises(ValidationError, match="either the time column or the rate"):
        Clock(**both)


def test_an_entry_of_a_list_is_picked():
    tables = {"q": np.array([[1.0, 2.0], [3.0, 4.0]])}
    assert pick(Column(column="q", unit="mm", index=1), tables, "run").tolist() == [2e-3, 4e-3]
    with pytest.raises(MachineError, match="has no entry") as caught:
        pick(Column(column="q", unit="mm", index=2), tables, "run")
    assert caught.value.limit == 2


def test_stamps_come_from_the_column_s_own_table():
    tables = {"a/t": np.array([0.0, 1.0]), "a/q": np.zeros(2), "t": np.array([5.0, 6.0]), "q": np.zeros(2)}
    clock = Clock(column="t", unit="ms")
    assert stamps_of(Column(column="a/q", unit="m"), tables, clock, "run").tolist() == [0.0, 1e-3]
    assert stamps_of(Column(column="q", unit="m"), tables, clock, "run").tolist() == [5e-3, 6e-3]
    assert stamps_of(Column(column="q", unit="m"), tables, Clock(rate=10.0), "run") is None


def test_units_are_taken_as_people_write_them():
    """The unit of a description is read as that of a header is."""
    written = {"N m": 1.0, "Nm": 1.0, "mNm": 1e-3, "turns/s": 2.0 * np.pi, "°": np.pi / 180.0}
    for unit, scale in written.items():
        assert Column(column="x", unit=unit).scale == pytest.approx(scale)


def test_several_columns_of_one_unit_are_written_as_one():
    class Arm(Description):
        joints: tuple[Column, ...]

    found = Arm.model_validate({"kind": "arm", "name": "a", "joints": {"column": ["j1", "j2"], "unit": "deg"}})
    assert found.joints == (Column(column="j1", unit="deg"), Column(column="j2", unit="deg"))
