"""Every effect: into the simulated robot, diagnosed, applied, and the corrected simulator shows a smaller gap."""

import pytest
from sher3_gap.closing import close_loop
from sher3_gap.excitation import excite
from sher3_gap.rehearsal import rehearse
from sher3_sim import EFFECTS
from simulated import ROBOT, SCATTER, signals

LARGER = {
    "backlash": {"width": 6e-5},
    "cable_drag": {"force": 1.0, "displacement": 5e-4},
    "thermal_expansion": {"coefficient": 5e-5},
}
RANDOM = ("command_jitter", "dropped_commands")
"""Two draws of these differ: the sizes are compared, not the samples."""
QUICK = ("thermal_expansion", "force_scale", "structural_vibration", "backlash", "controller_gain")


def closed(name):
    kind = EFFECTS[name]
    place = next((p for p in ("tip", "tilt") if p in kind.places), kind.places[-1])
    effect = kind(place, **LARGER.get(name, {}))
    wanted = [(excite(x, ROBOT, duration=3.0), r) for x in ("sweep", "steps", "postures", "loads") for r in (0, 1)]
    runs = rehearse(ROBOT, wanted, [effect], seed=5, scatter=SCATTER, temperature=27.0)
    return close_loop(signals(runs), ROBOT)


def check(name):
    found = closed(name)
    causes = [(c.effect, *c.rivals) for c in found.verdict.causes]
    assert any(name in each for each in causes), found.verdict
    if name in RANDOM:
        return
    shown = [gap for gap in (found.first, found.tip) if gap is not None and gap.closure is not None]
    assert any(gap.closure > 0.8 for gap in shown), (causes, found.first, found.tip)


@pytest.mark.parametrize("name", QUICK)
def test_applying_the_verdict_closes_the_gap(name):
    check(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(EFFECTS) - set(QUICK)))
def test_applying_any_verdict_closes_the_gap(name):
    check(name)
