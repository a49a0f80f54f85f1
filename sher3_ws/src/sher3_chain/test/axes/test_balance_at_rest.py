"""What a force at rest says of dry friction: an inequality, in squares of the floor."""

import numpy as np
import pytest
from sher3_chain.axes.causes.balance_at_rest import rest_loss
from sher3_chain.axes.evidence import gather_axis
from sher3_chain.axes.machine import facts_of
from sher3_chain.joint.record import AxesRun
from sher3_chain.thresholds import REST_FLOORS, STATIC
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.fit.fitting import fit
from sher3_effects import pages
from slides import axis_of, columns

MOTOR = Channel("motor_mechanics", "slide")
FORCE = 4.0
"""Constant force on an axis that moves one way and then rests."""


@pytest.fixture(scope="module")
def evidence():
    n = 3000
    position = np.r_[0.1 * np.linspace(0.0, 1.0, n), np.full(n, 0.1)]
    force = FORCE + 0.05 * np.random.default_rng(0).normal(size=2 * n)
    signals = {**columns("position"), **columns("effort", unit="N")}
    axis = axis_of(signals=signals, command_law={"kind": "force"}, mass=1.0)
    return gather_axis([AxesRun("run", 0.002, {"slide": {"position": position, "effort": force}})], axis, False)


def with_cause(evidence, effect, **shape):
    candidates = Candidates(evidence, [e for e in pages("axis", facts_of(evidence.axis)) if e.id == effect])
    (page,) = candidates.effects
    shape = shape or page.shapes(evidence.views, "slide")[0]
    return fit(evidence.data, [candidates.term(page, "slide", shape)])


def test_what_nothing_holds_counts(evidence):
    """Every sample at rest is FORCE over its floor, but for two floors."""
    rest = int(evidence.records[0].at_rest.sum())
    floor = float(evidence.floors[0][MOTOR][0])
    each = (FORCE / floor - REST_FLOORS) ** 2
    assert rest > 200
    assert rest_loss(evidence, fit(evidence.data, [])) == pytest.approx(rest * each, rel=0.02)


def test_a_constant_force_acts_at_rest_too(evidence):
    assert rest_loss(evidence, with_cause(evidence, "gravity_load", constant=1.0)) < 100.0


def test_dry_friction_holds_up_to_its_size(evidence):
    found = with_cause(evidence, "coulomb_friction")
    assert STATIC * found.of(0)[0] > FORCE
    assert rest_loss(evidence, found) == 0.0
