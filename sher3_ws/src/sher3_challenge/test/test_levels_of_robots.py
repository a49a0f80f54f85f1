"""How imperfect a robot is: drawn over a decade, kept to its tolerances, and bent by the share that was drawn."""

import numpy as np
import pytest
from sher3_challenge.oracle.oracle import excess, stage_residuals
from sher3_challenge.plants.kinds import Fault
from sher3_challenge.plants.level import BUILT, EXACT, SHAPE, Level
from sher3_challenge.plants.plant import Climate, RunPlan
from sher3_challenge.plants.registry import truth_plant
from sher3_description import load_robot
from sher3_gap.excitation import excite

ROBOT = load_robot()
WARM = Climate(25.0, 0.0, 100.0, 10**18)
PLAN = RunPlan(excite("sweep", ROBOT, posture="p1", duration=2.4), 0, 10**18, 1)


def test_levels_are_drawn_over_a_decade_each():
    drawn = [Level.drawn(seed) for seed in range(400)]
    for ends, values in ((BUILT, [x.built for x in drawn]), (SHAPE, [x.shape for x in drawn])):
        assert ends[0] <= min(values) < 1.2 * ends[0] and 0.8 * ends[1] < max(values) <= ends[1]
        assert np.median(values) == pytest.approx(np.sqrt(ends[0] * ends[1]), rel=0.2)


def test_deviations_grow_with_the_level_and_end_at_three_standard_deviations():
    rng = np.random.default_rng(1)
    small, large = (Level(built).off(rng, 2.0, 20_000) for built in (0.3, 3.0))
    assert np.std(small) == pytest.approx(0.6, rel=0.03) and np.abs(large).max() == 6.0
    assert not EXACT.off(rng, 2.0, 5).any()


def test_what_is_behind_the_axes_is_bent_by_the_share_and_a_robot_as_drawn_is_not():
    rng = np.random.default_rng(2)
    nominal, effect, inputs = np.zeros((20_000, 3)), rng.standard_normal((20_000, 3)), rng.uniform(-9, 9, (20_000, 8))
    own = Level(1.0, 0.04).bent(5, nominal, effect, inputs) - effect
    assert np.sqrt(np.mean(own**2) / np.mean(effect**2)) == pytest.approx(0.2, rel=0.1)
    assert EXACT.bent(5, nominal, effect, inputs) is effect


@pytest.mark.parametrize("plant", ["lumped", "tables", "mujoco"])
@pytest.mark.parametrize("fault", ["coulomb_friction", "lead_error", "platform_geometry_error"])
def test_an_effect_differs_from_its_page_by_about_the_share_drawn(plant, fault):
    """0.4 to 1.8 times its root: a run sees a piece of the bend, and a mean of it is a size of the effect."""
    truth = truth_plant(plant)
    kind = truth.library[fault]
    robots = [truth.make(ROBOT, 1, (Fault(kind, kind.places[0], 2 * kind.start, 3),), WARM) for _ in range(2)]
    plain, bent = robots
    object.__setattr__(plain, "level", Level(bent.level.built, 0.0))
    one, two = ([stage_residuals(r.run(PLAN, ideal=True), ROBOT)] for r in (bent, plain))
    drawn = [stage_residuals(truth.make(ROBOT, 0, (), WARM, built=False).run(PLAN, ideal=True), ROBOT)]
    key = f"{kind.stage}/{'tip' if kind.stage == 'mechanism' else kind.places[0]}"
    share = np.sqrt(excess(one, two)[key] / excess(two, drawn)[key])
    assert 0.4 < share / np.sqrt(bent.level.shape) < 1.8
