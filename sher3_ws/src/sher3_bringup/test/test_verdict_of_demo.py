"""A session that went wrong is said to have; on tables as a recording has them, without ROS."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
from sher3_bringup.demo.verdict import judge
from sher3_bringup.errors import EndedInFault, SessionFailed
from sher3_bringup.surgeon.script import Script
from sher3_bringup.surgeon.teleop_node import ScriptCommands

S = 1_000_000_000
BEGIN = 1_000_000 * S
SCRIPT = Script.model_validate(
    {
        "schema": "sher3.teleop/1",
        "steps": [
            {"name": "enable", "duration": 1.0, "command": "enable"},
            {"name": "push", "duration": 2.0, "pedal": 1.0, "wrench": (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)},
            {"name": "leave", "duration": 1.0},
        ],
    }
)
DISABLED = {"state": "DISABLED", "since": 0, "first_fault": None, "refused": None}
ENABLED = {**DISABLED, "state": "ENABLED", "since": BEGIN + S // 2}
FAULT_FOUND = {"code": "JOINTS_STALE", "value": 0.7, "limit": 0.6, "unit": "s", "source": "measured_js"}


def session(states=(DISABLED, ENABLED), reasons=(("PEDAL_RELEASED", 0.6), ("MOVING", 1.2)), way=1e-3):
    """Return a recorded run: supervisor states, the law's reasons with their times [s], and the tip's way [m]."""
    stamp = BEGIN + np.arange(0, 4 * S, S // 100)
    x = np.interp((stamp - BEGIN) / S, [1.0, 3.0], [0.0, way])
    laws = [{"reason": reason, "since": BEGIN + round(after * S)} for reason, after in reasons]
    return {
        "supervisor/status": SimpleNamespace(data=[json.dumps(state) for state in states]),
        "admittance/status": SimpleNamespace(data=[json.dumps(law) for law in laws]),
        "measured_cp": SimpleNamespace(stamp=stamp, position=np.stack([x, 0 * x, 0 * x], axis=1)),
    }


def test_a_good_session_passes():
    judge(session(), SCRIPT, BEGIN)


FAULT = {**ENABLED, "state": "FAULT", "since": BEGIN + 2 * S, "first_fault": FAULT_FOUND}
REFUSED = {**DISABLED, "refused": {"text": "enable is refused: a stream is silent"}}


def with_a_hole():
    """Return a session of which 1.5 s are not recorded."""
    recorded = session()
    tip = recorded["measured_cp"]
    kept = (tip.stamp < BEGIN + S) | (tip.stamp >= BEGIN + 5 * S // 2)
    recorded["measured_cp"] = SimpleNamespace(stamp=tip.stamp[kept], position=tip.position[kept])
    return recorded


@pytest.mark.parametrize(
    ("recorded", "sentence"),
    [
        (with_a_hole(), "recording has a hole; value 1.5 s without a pose .* too much else to do"),
        (session((DISABLED, REFUSED)), "never enabled: enable is refused: a stream is silent"),
        (session((DISABLED,)), "never enabled: no enable command arrived"),
        (session(reasons=(("MOVING", 1.2), ("WRENCH_STALE", 1.7))), r"stopped by itself 1.7 s .* wrench sample is too"),
        (session(way=2e-5), "tip did not move in step push; value 0.020 mm"),
    ],
)
def test_a_session_that_failed_is_one_sentence_and_an_exit_code(recorded, sentence):
    with pytest.raises(SessionFailed, match=sentence) as caught:
        judge(recorded, SCRIPT, BEGIN)
    assert caught.value.exit_code == 4


def test_a_fault_is_told_as_the_terminal_tells_it_with_an_exit_code_of_its_own():
    with pytest.raises(
        EndedInFault, match=r"FAULT JOINTS_STALE measured_js: 0.7 s, limit 0.6 s; .*; .* and enable \(2.0"
    ) as caught:
        judge(session((DISABLED, ENABLED, FAULT)), SCRIPT, BEGIN)
    assert caught.value.exit_code == 6


def test_a_stop_while_not_enabled_is_no_failure():
    """The streams end one after the other when the graph is taken down."""
    off = {**DISABLED, "since": BEGIN + 3 * S}
    judge(session((ENABLED, off), (("MOVING", 1.2), ("JOINTS_STALE", 3.5))), SCRIPT, BEGIN)


@pytest.mark.parametrize("answer", ["ENABLED", "FAULT"])
def test_enable_is_repeated_until_the_robot_has_answered_once(answer):
    """Never again after a fault, whatever the state is then."""
    commands = ScriptCommands(SCRIPT)
    times = [0.01 * k for k in range(100)]
    before = [commands(time) for time in times[:35]]
    assert before.count("enable") == 4 and before[0] == "enable"
    commands.heard("DISABLED")
    assert "enable" in [commands(time) for time in times[35:50]]
    commands.heard(answer)
    commands.heard("DISABLED")
    assert not any(commands(time) for time in times[50:])
    assert not any(commands(3.0 * time) for time in times[34:])
