"""A law of a joint that the library lacks: what its relative leaves is a function of what was recorded."""

import pytest
from lifts import machine, motion, needed, run_of
from sher3_diagnosis import diagnose


def test_a_joint_tells_what_its_law_may_depend_on_and_the_arm_everything_that_was_recorded(tmp_path):
    q, v, a = motion()
    (view,) = {id(v): v for v in machine(tmp_path / "lift.urdf").gather([run_of(q, needed(q, v, a))])[0].views}.values()
    told, g = view.quantities("swing"), len(view.run.grid)
    assert told["posture"].shape == told["acceleration"].shape == (g, 2)  # of both joints
    assert told["position"][:, 0] == pytest.approx(view.position[:, 1])
    assert told["direction"].shape == told["loading"].shape == (g, 3)
    assert view.everything().shape == (g, 8)


@pytest.mark.parametrize(("power", "foreign"), [(1, False), (3, True)])
def test_drag_with_the_cube_of_speed_is_no_viscous_friction(tmp_path, power, foreign):
    """The line through the cube closes nine tenths, and what it leaves is a function of the speed alone."""
    q, v, a = motion()
    effort = needed(q, v, a)
    effort[:, 1] += 0.15 * v[:, 1] ** power
    (place,) = diagnose(machine(tmp_path / "lift.urdf"), [run_of(q, effort)]).verdict.places
    outside = sum(a.probability for a in place.answers if a.answer == "outside_library")
    assert outside > 0.7 if foreign else outside < 0.05
