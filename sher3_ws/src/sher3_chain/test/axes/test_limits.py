"""A drive at its limit, on commands written down by hand."""

import numpy as np
import pytest
from sher3_chain.axes.limits import limit_finding, needed_force, pinned_in
from sher3_chain.joint.record import AxesRun
from slides import axis_of, columns

SIGNALS = {**columns("position", "reference"), **columns("command", "effort", unit="N")}
LAW = {"kind": "force", "position_gain": 100.0}


def axis(**law):
    return axis_of(signals=SIGNALS, command_law={**LAW, **law}, encoder_resolution=1e-6)


def run(command, reference=1.0, effort=None):
    n = len(command)
    found = {"position": np.zeros(n), "reference": np.full(n, reference), "command": np.asarray(command, dtype=float)}
    return AxesRun("run", 0.01, {"slide": {**found, **({"effort": effort} if effort is not None else {})}})


def test_a_command_that_stays_below_its_need_is_pinned():
    """An error of 1 m asks for 100 N; the command stays at 40 N, so that the gap is 60 N."""
    found = pinned_in(run(np.full(200, 40.0)), axis())
    assert (found.level, found.share) == (40.0, 1.0)
    assert found.gap == pytest.approx(60.0)
    assert found.floor == pytest.approx(0.04)  # a thousandth of the level: nothing measured tells more
    finding = limit_finding([run(np.full(200, 40.0))], axis())
    assert finding.causes[0].parameters["limit"].value == 40.0
    assert finding.closure.value == pytest.approx(1.0)
    assert (finding.where.stage, finding.where.unit) == ("drive", "N")
    assert finding.where.regime == "100% of the time at the limit"


def test_the_limit_is_read_off_the_measured_force():
    found = limit_finding([run(np.full(200, 40.0), effort=np.full(200, 39.0))], axis())
    assert found.causes[0].parameters["limit"].value == 39.0


@pytest.mark.parametrize(
    "command",
    [np.zeros(200), np.r_[np.full(4, 40.0), np.full(196, 20.0)], np.tile([40.0, 40.0, 20.0, 20.0], 50)],
    ids=["no force", "for a moment", "never ten samples in a row"],
)
def test_a_command_that_touches_its_largest_value_is_free(command):
    assert pinned_in(run(command), axis()) is None


def test_a_command_that_meets_its_need_is_free():
    assert limit_finding([run(np.full(200, 100.0))], axis()) is None


def test_without_a_command_or_a_force_law_there_is_none_to_read():
    assert (
        limit_finding([run(np.full(200, 40.0))], axis_of(signals=columns("position"), command_law={"kind": "none"}))
        is None
    )


def test_without_gains_the_need_is_the_weight_on_the_way():
    """A pendulum of 3 N m that hangs at 0 and is sent to pi passes its largest weight, at a quarter turn."""
    pendulum = axis_of(
        motion="rotary", signals=SIGNALS, command_law={"kind": "force", "goal": np.pi}, gravity={"arm": 3.0}
    )
    assert needed_force(run(np.full(50, 1.0)), pendulum) == pytest.approx(3.0, rel=1e-3)
    nowhere = AxesRun("run", 0.01, {"slide": {"position": np.zeros(50)}})
    assert not needed_force(nowhere, axis()).any()
