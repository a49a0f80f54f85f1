"""A SCARA that its drawing has upright and that hangs elsewhere: its weights are worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest
from scaras import C1, C2, L1, L2, M1, M2, M3, NAMES, machine, motion, record
from sher3_chain.manipulator.readings.senses import thinned
from sher3_diagnosis import diagnose

DRY = (3.0, 1.5, 4.0)
RATE = 250.0


def weights(q, gravity):
    """What the joints need to hold the links up, (n, 3), less the weight of a quill that stands upright."""
    x, y, z = gravity
    first, second = M1 * C1 + (M2 + M3) * L1, M2 * C2 + M3 * L2
    upper, fore = q[:, 0], q[:, 0] + q[:, 1]
    elbow = second * (x * np.sin(fore) - y * np.cos(fore))
    shoulder = first * (x * np.sin(upper) - y * np.cos(upper)) + elbow
    return np.stack([shoulder, elbow, np.full(len(q), -M3 * (z + 9.81))], 1)


def verdict(path, pull, turned=1.0, **stated):
    run = record(RATE, DRY)
    added = weights(motion(np.arange(0.0, 30.0, 1.0 / RATE))[0], pull)
    signals = {
        name: {**run.signals[name], "effort": turned * (run.signals[name]["effort"] + added[:, i])}
        for i, name in enumerate(NAMES)
    }
    arm = machine(path, RATE)
    arm = replace(arm, described=arm.described.model_copy(update=stated))
    return diagnose(arm, [replace(run, signals=signals)]).verdict


@pytest.fixture
def path(tmp_path):
    return tmp_path / "scara.urdf"


@pytest.mark.parametrize("gravity", [(9.81, 0.0, 0.0), (0.0, -9.81, 0.0), (4.905, 0.0, -8.496)])
def test_an_arm_on_a_wall_or_a_slope_is_said_and_keeps_its_causes(path, gravity):
    found = verdict(path, gravity)
    said = [note for note in found.notes if "hangs otherwise" in note]
    assert len(said) == 1
    told = [float(x) for x in said[0].partition("(")[2].partition(")")[0].split(",")]
    assert told == pytest.approx(gravity, abs=0.25)
    sizes = {(c.effect, c.actuator): c.parameters["force"].value for c in found.causes if "force" in c.parameters}
    for name, size in zip(NAMES[:2], DRY, strict=False):
        assert sizes["coulomb_friction", name] == pytest.approx(size, rel=0.1)
    assert not {c.effect for c in found.causes} & {"spring_torque", "cable_torque", "payload_mass", "torque_constant"}


@pytest.mark.parametrize("turned", [1.0, -1.0])
def test_an_upright_arm_is_not_hung_elsewhere_even_where_its_efforts_are_turned(path, turned):
    found = verdict(path, (0.0, 0.0, -9.81), turned)
    assert not any("hangs otherwise" in note for note in found.notes)


def test_a_joint_that_moves_for_one_sample_has_no_part_in_where_an_arm_hangs(path, monkeypatch):
    """One sample follows from four numbers of the joint's own exactly, and nothing over nothing is no weight."""

    def hardly(views):
        *signals, judged = thinned(views)
        judged[:, 1] = np.arange(len(judged)) == np.flatnonzero(judged[:, 1])[0]
        return *signals, judged

    monkeypatch.setattr("sher3_chain.manipulator.readings.mounted.thinned", hardly)
    assert any("hangs otherwise" in note for note in verdict(path, (9.81, 0.0, 0.0)).notes)


def test_gravity_that_is_stated_is_believed(path):
    found = verdict(path, (9.81, 0.0, 0.0), gravity=(0.0, 0.0, -9.81))
    assert not any("hangs otherwise" in note for note in found.notes)


def test_what_a_brake_holds_at_rest_does_not_turn_gravity(path):
    """Between motions the arm rests where it is, and its drives feel what is as good as a weight on a wall."""
    rate, moves, stays = 100.0, 50, 200
    run, t = record(rate, DRY), np.arange(3000)
    at = np.concatenate([np.r_[t[i : i + moves], np.full(stays, i + moves - 1)] for i in t[::moves]])
    rests = np.tile(np.arange(moves + stays) >= moves, len(t) // moves)
    held = weights(motion(at / rate)[0], (9.81, 0.0, 0.0))
    signals = {}
    for i, name in enumerate(NAMES):
        position, effort = (run.signals[name][x][at] for x in ("position", "effort"))
        signals[name] = {"position": position, "effort": np.where(rests, held[:, i], effort)}
    found = diagnose(machine(path, rate), [replace(run, signals=signals)]).verdict
    assert not any("hangs otherwise" in note for note in found.notes)
