"""An effort in another unit than stated is named with its factor; no friction or payload is made of it."""

import numpy as np
import pytest
from sher3_chain.axes.scale import commands_force, slip_of
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.signals import signals_of
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from slides import MASS, PERIOD, axis_of, columns, driven, machine

ALONE = {"signals": {**columns("position"), **columns("effort", unit="N")}, "command_law": {"kind": "force"}}
BESIDE = {"signals": {**columns("position", "reference"), **columns("command", "effort", unit="N")}}
LOADED = {"signals": {**columns("position", "load"), **columns("effort", unit="N")}, "command_law": {"kind": "force"}}


@pytest.fixture(scope="module")
def rows():
    return driven(coulomb=8.0, viscous=20.0)


def run_with(rows, factor, **more):
    effort = factor * (rows[:, 2] + 0.05 * np.random.default_rng(1).normal(size=len(rows)))
    names = dict(zip(("position", "reference", "command"), rows.T, strict=True))
    return AxesRun("run", PERIOD, {"slide": {**names, "effort": effort, **more}})


def slip(rows, factor, **changes):
    axis = axis_of(**changes)
    run = run_with(rows, factor)
    kept = {k: x for k, x in run.signals["slide"].items() if getattr(axis.signals, k) is not None}
    return slip_of([signals_of(AxesRun("run", PERIOD, {"slide": kept}), axis, "run")], axis)


@pytest.mark.parametrize(
    ("factor", "changes", "than"),
    [
        (1000.0, ALONE, "its model needs"),
        (-1e-3, ALONE, "its model needs"),
        (1000.0, {**BESIDE, "mass": "unknown"}, "its command asks for"),
        (9.80665, {**BESIDE, "mass": "unknown"}, "its command asks for"),
    ],
)
def test_another_unit_is_named(rows, factor, changes, than):
    said = slip(rows, factor, **changes)
    assert said is not None and than in said and "state its `factor`" in said
    assert float(said.split()[3]) == pytest.approx(factor, rel=0.1)


@pytest.mark.parametrize(
    "changes",
    [
        {**ALONE, "mass": MASS / 6.0},
        {**ALONE, "mass": 3.0 * MASS},
        {**ALONE, "mass": "unknown"},
        {**BESIDE, "mass": "unknown"},
    ],
    ids=["payload", "light", "nothing known", "command"],
)
def test_a_payload_or_a_true_unit_is_none(rows, changes):
    assert slip(rows, 1.0, **changes) is None


def test_a_command_in_volts_asks_for_no_force():
    volts = {"signals": {**columns("position"), **columns("effort", unit="N"), **columns("command", unit="V")}}
    assert not commands_force(axis_of(**volts, mass="unknown"))
    assert commands_force(axis_of(**volts, mass="unknown", command_law={"kind": "force", "gain": 35.0}))


def test_with_nothing_else_to_judge_the_refusal_names_it(rows):
    with pytest.raises(MachineError, match=r"slide: effort is \d+ times what its model needs: state its `factor`"):
        diagnose(machine(**ALONE), [run_with(rows, 1000.0)])


def test_a_second_encoder_is_judged_all_the_same(rows):
    """Play is told by the encoders; no spring or friction is made of the effort."""
    q, side = rows[:, 0], rows[0, 0]
    load = np.empty_like(q)
    for k, x in enumerate(q):
        load[k] = side = min(max(side, x - 1e-4), x + 1e-4)
    verdict = diagnose(machine(**LOADED), [run_with(rows, 1000.0, load=load)]).verdict
    (cause,) = verdict.causes
    assert cause.effect == "backlash" and cause.parameters["width"].value == pytest.approx(2e-4, rel=0.05)
    assert any(
        "times what its model needs: state its `factor`: its force balance is not judged" in n for n in verdict.notes
    )
