"""`sher3 fault` into a running `sher3 up`, and what it refuses."""

from __future__ import annotations

import json
import signal
import subprocess

import pytest
from processes import child_environment, sher3_command
from sher3_cli.root import main

pytestmark = pytest.mark.graph


@pytest.mark.parametrize(
    ("words", "status", "part"),
    [
        (("sensor", "off"), 2, "no such component; value sensor"),
        (("pedal", "broken"), 2, "no such fault; value broken"),
        (("pedal", "slow", "-p", "every=0"), 2, "every is out of range; value 0"),
        (("pedal", "slow", "-p", "every=many"), 2, "write NAME=NUMBER"),
    ],
)
def test_what_does_not_exist_is_refused_before_anything_is_sent(capsys, words, status, part):
    with pytest.raises(SystemExit) as left:
        main(["fault", *words])
    assert left.value.code == status
    assert part in capsys.readouterr().err


def test_without_a_robot_on_mocks_nothing_is_injected(sher3, domain):
    """On hardware there is no plant to take the fault either."""
    result = sher3("fault", "pedal", "off", "--domain", str(domain))
    assert result.returncode == 3
    assert f"no robot on mocks runs on domain {domain}; hardware takes no faults" in result.stderr


@pytest.mark.flaky(reruns=2)
def test_a_running_robot_takes_a_fault_and_refuses_another(sher3, domain):
    command = sher3_command("up", "--patient", "--layout", "composed", "--domain", str(domain), "--realtime", "0")
    up = subprocess.Popen(command, env=child_environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        line = up.stdout.readline()
        assert line.startswith("ready"), line + up.stderr.read()
        taken = sher3("fault", "force_sensor", "stuck", "--for", "0.5", "--domain", str(domain), "--json")
        assert taken.returncode == 0, taken.stderr
        assert json.loads(taken.stdout)["answer"] == "broken: force_sensor stuck"
        refused = sher3("fault", "bus2", "off", "--domain", str(domain))
        assert refused.returncode == 2 and "no such channel; value bus2" in refused.stderr
        up.send_signal(signal.SIGINT)
        assert up.wait(timeout=60) == 0
    finally:
        up.kill()
        up.communicate()
