"""Each part of a chain declares how its causes are looked for."""

from dataclasses import FrozenInstanceError

import pytest
from lifts import machine as lift
from sher3_chain.axes.causes.behind_encoder import friction_then_hidden, something_hides
from sher3_chain.axes.causes.plan import AXIS
from sher3_chain.axes.command.law import LAW
from sher3_chain.manipulator.causes.plan import JOINT
from sher3_diagnosis.attribute.candidates import Candidates
from slides import driven, machine, run_of


@pytest.fixture(scope="module")
def parts():
    arm = machine()
    return arm, arm.gather([run_of(driven(8.0, coulomb=8.0))])


def test_an_axis_its_command_and_a_joint_have_plans_of_their_own(parts, tmp_path):
    arm, found = parts
    assert [arm.of(part).plan(part) for part in found] == [AXIS, LAW]
    assert lift(tmp_path / "lift.urdf").plan(None) is JOINT
    assert all(plan.down_to_floor for plan in (AXIS, LAW, JOINT))
    with pytest.raises(FrozenInstanceError):
        AXIS.causes = 9


def test_what_hides_behind_one_encoder_comes_second_and_beside_a_dry_friction(parts):
    """The slide has no friction in its model and one encoder, at the motor: a load may hide behind it."""
    arm, (axis, _) = parts
    hidden = [e for e in arm.effects(axis) if e.unseen]
    every = Candidates(axis, arm.effects(axis), order=friction_then_hidden)
    assert hidden and something_hides(every, axis.null())
    assert not something_hides(Candidates(axis, [e for e in every.effects if not e.unseen]), axis.null())
    first = every.search(axis.channels)
    assert first and all((e.plain and e.dry) or e.family == "compliance" for e in (f.terms[-1].effect for f in first))
    second = every.search(axis.channels, first[0].terms)
    kinds = {(f.terms[-1].effect.unseen, f.terms[-1].effect.family) for f in second}
    assert all(unseen or family in ("timing", "friction") for unseen, family in kinds)
