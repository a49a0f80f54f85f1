"""Logs that are slower than the loop that takes their controls: each control holds from row to row, or goes on."""

from types import SimpleNamespace

import mujoco
import numpy as np
import pytest
import sher3.gap as gap
from drawn_arms import NOISE, asked, drawn_xml, logged
from sher3_chain.joint.description import CommandLaw
from sher3_chain.manipulator.readings.held import Single, held, within_a_row

STEP, SECONDS = 0.002, 12.0
HOLD, GO_ON = "controls hold from row to row", "controls go on evenly"


def log_of(model, steps, every=1, late=0):
    """Return a log of a servo arm, a row every `steps`; its control changes `every` so many steps."""
    rng, data, rows = np.random.default_rng(4), mujoco.MjData(model), []
    h, n = model.opt.timestep, round(SECONDS / model.opt.timestep)
    goals = asked(rng, np.arange(n) * h, model.nu) * model.actuator_gear[:, 0]
    for i in range(n):
        data.ctrl[:] = goals[max(0, i - i % every - late)]
        if i % steps == 0:
            rows.append([i * h, *goals[i - i % every], *data.qpos])
        mujoco.mj_step(model, data)
    table = np.array(rows)
    k = model.nu
    return {
        "time": table[:, 0],
        "ctrl": table[:, 1 : 1 + k],
        "qpos": table[:, 1 + k :] + NOISE * rng.normal(size=(len(table), k)),
    }


def arm(seed, **changes):
    xml = drawn_xml(np.random.default_rng(seed), joints=2, methods=("implicitfast",))
    model = mujoco.MjModel.from_xml_string(xml)
    for name, (place, more) in changes.items():
        getattr(model, name)[place] += more
    return xml, model


@pytest.mark.parametrize(("seed", "steps"), [(700, 2), (701, 5), (704, 10), (705, 5)])
def test_a_healthy_arm_that_was_logged_once_a_control_has_no_gap(seed, steps):
    """A command 1 to 10 ms late was told of each of them; servos at even seeds, motors at odd ones."""
    xml = drawn_xml(np.random.default_rng(seed), servo=seed % 2 == 0)
    log = logged(xml, seed, steps)
    table = {"time": log.time, "qpos": log.qpos, "ctrl": log.ctrl}
    for record in (table, {**table, "actuator_force": log.actuator_force}):
        answer = gap.diagnose(xml, record)
        assert answer.status == "no_gap", answer.headline
        assert any(HOLD in note for note in answer.verdict.notes)


def test_controls_that_go_on_between_the_rows_act_as_read():
    """Every fifth step was logged of a control that changes at each one."""
    xml, model = arm(4100)
    answer = gap.diagnose(xml, log_of(model, steps=5))
    assert answer.status == "no_gap", answer.headline
    assert not any(HOLD in note or GO_ON in note for note in answer.verdict.notes)


@pytest.mark.parametrize("steps", [2, 5, 10])
def test_a_control_that_holds_for_several_rows_is_no_slow_channel(steps):
    """Logged at 50 to 250 Hz, its control at 50 Hz: a path between its readings was late by half of that."""
    xml, model = arm(4102)
    answer = gap.diagnose(xml, log_of(model, steps=steps, every=10))
    assert answer.status == "no_gap", answer.headline


@pytest.mark.parametrize("steps", [1, 4, 10])
def test_a_friction_is_told_however_slow_the_log(steps):
    xml, model = arm(4104, dof_frictionloss=(1, 0.8))
    answer = gap.diagnose(xml, log_of(model, steps=steps, every=steps))
    (cause,) = answer.causes
    assert (cause.effect, cause.actuator) == ("coulomb_friction", "shoulder")
    assert cause.parameters["force"].value == pytest.approx(0.8, rel=0.06)
    if steps > 1:
        replay = answer.simulate().joints["shoulder"]
        assert replay.after < 0.3 * replay.before, "its servo goes on within a row there, too"


@pytest.mark.parametrize("steps", [1, 5])
def test_a_dead_time_is_counted_from_the_control_that_holds(steps):
    """20 ms, while the log has a row for each step or for five."""
    xml, model = arm(4106)
    answer = gap.diagnose(xml, log_of(model, steps, steps, round(0.02 / model.opt.timestep)))
    assert {c.effect for c in answer.causes} == {"command_delay"}
    for cause in answer.causes:
        assert cause.parameters["reference_delay"].value == pytest.approx(0.02, rel=0.03)


def test_a_control_that_holds_is_late_by_half_a_row_less_half_a_step():
    line = np.arange(9.0)
    assert np.allclose(held(line, 10.0)[1:], line[1:] - 0.45)
    assert np.array_equal(held(line, 1.0), line)


def test_what_a_servo_does_within_a_row_vanishes_with_the_row():
    law = CommandLaw(kind="force", position_gain=400.0, velocity_gain=20.0, loop=STEP)
    drive = Single(SimpleNamespace(command_law=law), 0.5, 0.5)
    each = [within_a_row(drive, SimpleNamespace(period=n * STEP, steps=n)) for n in (1, 2, 5, 10)]
    assert each[0] == (0.0, 0.0, 1.0, 0.0)
    sizes = [abs(x.inertia) for x in each]
    assert sizes == sorted(sizes)
    assert sizes[-1] < 0.01 * 0.5, "of a row of 20 ms a mass of 0.5 kg m^2 has less than a hundredth too much"
