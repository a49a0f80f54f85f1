"""Links and rotors found from a log, beside friction: what the corrected model is worth on another motion."""

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import drawn_xml, log_of_servos

SECONDS = 8.0


def rough(rng):
    """The MJCF of a drawn arm, and the model of one with other links, rotors and 0.8 N m of friction at the elbow."""
    xml = drawn_xml(rng, servo=True, joints=3).replace('gravcomp="1"', "")
    spec = mujoco.MjSpec.from_string(xml)
    for body in spec.bodies[1:]:
        body.geoms[0].mass *= rng.uniform(0.6, 1.8)
        body.joints[0].armature *= rng.uniform(1.0, 3.0)
    spec.joint("elbow").frictionloss += 0.8
    return xml, spec.compile()


@pytest.mark.parametrize("seed", [11, 13])
def test_identified_inertias_stand_in_the_corrected_model(seed):
    rng = np.random.default_rng(seed)
    xml, real = rough(rng)
    answer = gap.diagnose(xml, log_of_servos(real, rng, SECONDS), inertias="identified")
    assert {(c.effect, c.actuator) for c in answer.causes} == {("coulomb_friction", "elbow")}
    places = {x.actuator for x in answer.verdict.identified}
    assert {"turn", "shoulder", "elbow"} <= places
    left = gap.diagnose(answer.corrected().text, log_of_servos(real, rng, SECONDS)).verdict.where
    assert all(place.gap < 0.1 for place in left)  # N m; weights are off by newton metres
    replays = answer.simulate().joints.values()
    assert sum(r.after for r in replays) < 0.2 * sum(r.before for r in replays)


def test_inertias_without_a_model_are_refused():
    with pytest.raises(gap.InputError, match="arm's model"):
        gap.diagnose(None, {"time": np.arange(9.0), "q": np.arange(9.0)}, inertias="identified")
