"""How long `sher3 fault` waits for a robot: as many turns on a busy computer as on an idle one."""

from types import SimpleNamespace

import pytest
from sher3_bringup.errors import StartError
from sher3_safety.runs import fault_node


@pytest.mark.parametrize(("turn", "last"), [(0.02, 251), (0.5, 251), (0.001, 5001)])
def test_the_last_turn_is_late_enough_on_any_computer(monkeypatch, turn, last):
    """Turns of 20 ms are 5 s; of half a second, 125 s; messages that cut them short end no wait before 5 s."""
    past = [0]
    monkeypatch.setattr(fault_node, "time", SimpleNamespace(monotonic=lambda: past[0] * turn))

    def spin_once(_):
        past[0] += 1

    executor = SimpleNamespace(spin_once=spin_once)
    fault_node.wait_for(executor, lambda: past[0] == last - 1, "in time")
    past[0] = 0
    with pytest.raises(StartError, match="nobody answers; limit 5 s"):
        fault_node.wait_for(executor, lambda: False, "nobody answers")
    assert past[0] == pytest.approx(last, abs=1)


def test_a_request_is_sent_at_once_and_each_second_until_it_is_answered(monkeypatch):
    past, sent = [0.0], []
    monkeypatch.setattr(fault_node, "time", SimpleNamespace(monotonic=lambda: past[0]))
    asked = fault_node.repeated(lambda: sent.append(past[0]), lambda: past[0] >= 2.5)
    while not asked():
        past[0] += 0.25
    assert sent == [0.0, 1.0, 2.0]
