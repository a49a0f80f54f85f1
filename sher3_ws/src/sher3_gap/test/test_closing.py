"""Every effect: into the simulated robot, diagnosed, applied, and the corrected simulator shows a smaller gap."""

import pytest
from closing import close_loop
from sher3_effects import plants
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from simulated import ROBOT, SCATTER, signals

GIVEN = {
    "backlash": ("roll", {"width": 2e-3}),
    "cable_drag": ("delta_2", {"stiffness": 400.0, "force": 0.5}),
    "command_delay": ("all", {}),
    "encoder_scale": ("tilt", {"relative": 4e-3}),
    "force_saturation": ("delta_2", {"limit": 8.0}),
    "joint_clearance": ("delta_1", {"clearance": 8e-5}),
    "payload_mass": ("delta_3", {"mass": 1.0}),
    "rail_tilt": ("delta_1", {"angle": 1e-2}),
    "thermal_expansion": ("tip", {"coefficient": 5e-5}),
    "torque_constant": ("tilt", {"relative": 0.4}),
    "transmission_compliance": ("delta_2", {"compliance": 1e-5}),
}
"""Where an effect sits and how large it is, where the default does not show in these runs."""
RANDOM = {"command_jitter": "sigma", "dropped_commands": "probability"}
"""Two draws of these differ: the sizes are compared, not the samples."""
ALIKE = ("joint_clearance",)
"""Effects that look like another one in these runs: what counts is that the gap closes."""
CLOSES = {"backlash": 0.3}
"""Least closure where it is not 0.8: on which side of its gap a load starts is not known, and it travels to and fro."""
QUICK = (
    "backlash",
    "controller_gain",
    "force_scale",
    "structural_vibration",
    "thermal_expansion",
    "transmission_compliance",
)


def made(name):
    kind = plants()[name]
    place, values = GIVEN.get(name, (next((p for p in ("tip", "tilt") if p in kind.sites), kind.sites[-1]), {}))
    return kind(place, **values)


def closed(effect):
    wanted = [(excite(x, ROBOT, duration=3.0), r) for x in ("sweep", "steps", "postures", "loads") for r in (0, 1)]
    runs = rehearse(ROBOT, wanted, [effect], seed=5, scatter=SCATTER, temperature=27.0)
    return close_loop(signals(runs), ROBOT)


def check(name):
    effect = made(name)
    found = closed(effect)
    causes = [(c.effect, *c.rivals) for c in found.verdict.causes]
    assert name in ALIKE or any(name in each for each in causes), found.verdict
    if name in RANDOM:
        (size,) = [c.parameters[RANDOM[name]].value for c in found.verdict.causes if c.effect == name]
        # some 60 dropped commands are expected in ticks that tell: three standard deviations are 0.39 of their number
        assert size == pytest.approx(getattr(effect, RANDOM[name]), rel=0.4)
        return
    shown = [gap for gap in (found.first, found.tip) if gap is not None and gap.closure is not None]
    assert any(gap.closure > CLOSES.get(name, 0.8) for gap in shown), (causes, found.first, found.tip)


@pytest.mark.parametrize("name", QUICK)
def test_applying_the_verdict_closes_the_gap(name):
    check(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(plants()) - set(QUICK)))
def test_applying_any_verdict_closes_the_gap(name):
    check(name)
