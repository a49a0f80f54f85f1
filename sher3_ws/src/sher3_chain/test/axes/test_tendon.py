"""A cable in its sheath: told from play and hysteresis by its tension, or by a loop that grows along the travel."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from sher3_effects.operators import sheath
from slides import columns, machine

PERIOD = 0.02
T = np.arange(0.0, 20.0, PERIOD)
MOTOR = 8e-3 * np.sin(0.8 * T) + 3e-3 * np.sin(1.9 * T)
COUNT = 1e-6


def rubbed(wrap, cable=4000.0, spring=900.0, slack=16.0, pieces=6):
    """Joint and tension at the motor: springs in line, whose nodes rub in proportion to the tension, by relaxation."""
    stiff, rub, u = cable * pieces, wrap / (pieces - 1), [0.0] * (pieces + 1)
    out = []
    for place in MOTOR.tolist():
        u[0] = place
        for _ in range(300):
            moved = 0.0
            for node in (*range(1, pieces, 2), *range(2, pieces, 2)):
                left = slack + stiff * (u[node - 1] - u[node])
                right = slack + stiff * (u[node] - u[node + 1])
                over = abs(left - right) - abs(0.5 * (left + right)) * rub
                if over > 0.0:
                    step = over / (2.0 * stiff)
                    u[node] += step if left > right else -step
                    moved = max(moved, step)
            u[-1] = stiff * u[-2] / (stiff + spring)
            if moved < 1e-9:
                break
        out.append((u[-1], slack + stiff * (u[0] - u[1])))
    return np.array(out).T


@pytest.fixture(scope="module")
def joint_and_tension():
    return rubbed(0.45)


def verdict_of(joint, **effort):
    rng = np.random.default_rng(0)
    load = joint + 2e-6 * rng.normal(size=len(T)) + 0.7
    signals = columns("position", "load") | (columns("effort", unit="N") if effort else {})
    run = AxesRun("run", PERIOD, {"slide": {"position": COUNT * np.round(MOTOR / COUNT), "load": load, **effort}})
    law = {"kind": "force" if effort else "none"}
    return diagnose(machine(signals=signals, mass=None, command_law=law, encoder_resolution=COUNT), [run]).verdict


def test_the_sliding_part_grows_from_the_beginning():
    """Two pieces, wrap 0.2: after a rise by 0.15 the first is 0.1 behind, the second still rests; after 0.5 both."""
    found = sheath(np.array([0.0, 0.15, 0.5, 0.45]), 0.2, 2)
    assert found == pytest.approx(np.array([[0.0, 0.0], [0.05, 0.0], [0.4, 0.3], [0.4, 0.3]]))


def test_a_tendon_is_told_by_its_tension(joint_and_tension):
    joint, tension = joint_and_tension
    verdict = verdict_of(joint, effort=tension + 0.05 * np.random.default_rng(1).normal(size=len(T)))
    assert verdict.status == "attributed" and [c.effect for c in verdict.causes] == ["tendon_friction"]
    found = verdict.causes[0].parameters
    assert found["wrap"].value == pytest.approx(0.45, rel=0.1)
    assert found["stiffness"].value == pytest.approx(4000.0, rel=0.08)
    assert not {"backlash", "transmission_hysteresis"} & set(verdict.causes[0].rivals)


def test_without_a_tension_its_loop_grows_along_the_travel():
    """A loop that is 4 times as wide at one end as at the other."""
    side, width = MOTOR[0], 2e-4
    load = np.empty_like(MOTOR)
    for k, x in enumerate(MOTOR):
        half = 0.5 * width * (1.0 + 0.6 * x / 0.011)
        side = min(max(side, x - half), x + half)
        load[k] = side
    verdict = verdict_of(load)
    assert verdict.causes[0].effect == "tendon_friction"
    assert verdict.causes[0].parameters["growth"].value == pytest.approx(0.6, abs=0.2)


def test_play_is_no_tendon():
    side, load = MOTOR[0], np.empty_like(MOTOR)
    for k, x in enumerate(MOTOR):
        side = min(max(side, x - 1e-4), x + 1e-4)
        load[k] = side
    verdict = verdict_of(load)
    assert [c.effect for c in verdict.causes] == ["backlash"]
