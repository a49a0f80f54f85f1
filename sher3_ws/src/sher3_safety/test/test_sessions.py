"""What a healthy robot is asked to do: hands of every strength that the sensor can read, set-points without a jump."""

from __future__ import annotations

import json

import numpy as np
import pytest
from sher3_description import load_robot
from sher3_safety.runs.healthy import KEPT, run_healthy
from sher3_safety.runs.sessions import (
    ACROSS,
    REST,
    SESSION,
    STRONGEST,
    TARE,
    TORQUE,
    WEAKEST,
    excitations,
    surgeon,
    with_tool,
)

ROBOT = load_robot()


def test_hands_are_of_every_strength_and_none_saturates_the_sensor():
    pushes = [step.wrench for seed in range(30) for step in surgeon(seed).steps if step.name == "push"]
    wrenches = np.array(pushes)
    strength = np.linalg.norm(wrenches[:, :3], axis=1)
    assert strength.max() <= STRONGEST and strength.max() > 5.0 and strength.min() < 2.0 * WEAKEST
    assert np.abs(wrenches[:, :2]).max() <= ACROSS and np.abs(wrenches[:, 3:]).max() <= TORQUE
    lever = float(np.linalg.norm(ROBOT.force_sensor.position))
    most = 1.3 * (TORQUE + lever * ACROSS)  # with the dither on top
    assert most < 0.98 * min(ROBOT.force_sensor.range_torque)


def test_a_surgeon_takes_back_every_push_and_leaves_in_time():
    script = surgeon(7)
    pushes = [step for step in script.steps if step.name in ("push", "back")]
    assert np.allclose(sum(np.array(step.wrench) * step.duration for step in pushes), 0.0)
    assert script.duration == pytest.approx(SESSION, abs=1.0)


def test_a_tool_is_changed_without_power_and_tared_before_the_robot_is_enabled_again():
    steps = surgeon(7).steps
    tares = [index for index, step in enumerate(steps) if step.name == TARE]
    assert len(tares) == 2
    for index in tares:
        let_go, disable, change, tare, enable = steps[index - 3 : index + 2]
        assert not any(let_go.wrench) and disable.command == "disable" and any(change.wrench)
        assert not any(tare.wrench) and tare.duration == REST and enable.command == "enable"
        assert all(step.pedal == 0.0 for step in steps[index - 3 : index + 2])


def test_tools_differ_and_the_robot_knows_them():
    tools = {with_tool(ROBOT, seed).force_sensor.tool_mass for seed in range(20)}
    assert len(tools) == 20 and min(tools) < 0.5 * max(tools)
    assert with_tool(ROBOT, 3) == with_tool(ROBOT, 3)


def test_excitations_follow_each_other_without_a_jump():
    goals, wrenches = excitations(ROBOT, 4)
    assert len(goals) == len(wrenches) and len(goals) * ROBOT.control_period >= SESSION
    assert not goals[0].any()
    speed = np.abs(np.diff(goals, axis=0)).max(axis=0) / ROBOT.control_period
    assert all(speed <= [1.02 * actuator.limits.velocity for actuator in ROBOT.actuators])


def test_sessions_that_are_kept_are_not_run_again(tmp_path):
    lines = [{"seed": seed, "trips": ["CLOCK"] * (seed == 6)} for seed in range(3, 8)]
    (tmp_path / KEPT).write_text("".join(json.dumps(line) + "\n" for line in lines))
    found = run_healthy(tmp_path / "bags", 4.0, 4, 1, lambda _: None, tmp_path)
    assert (found["what"], found["seeds"], found["hours"]) == (["CLOCK"], [4, 7], pytest.approx(4 / 60))
    assert not (tmp_path / "bags").exists() and found["seconds"] < 10.0
