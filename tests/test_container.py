"""The container files name commands that exist and publish nothing beyond the loopback interface."""

import pytest
import yaml
from sher3_cli.root import COMMANDS
from sources import ROOT

COMPOSE = yaml.safe_load((ROOT / "docker" / "compose.yaml").read_text())


@pytest.mark.parametrize("service", COMPOSE["services"])
def test_a_service_starts_a_command_and_opens_no_port(service):
    entry = COMPOSE["services"][service]
    program, command, *options = entry["command"]
    assert program == ".venv/bin/sher3" and command in COMMANDS
    assert "--other-hosts" not in options and "ports" not in entry
    assert (ROOT / "docker" / entry["build"]["context"] / entry["build"]["dockerfile"]).is_file()


def test_the_dockerfile_knows_what_compose_asks_for():
    text = (ROOT / "docker" / "Dockerfile").read_text()
    asked = {name for service in COMPOSE["services"].values() for name in service["build"]["args"]}
    assert all(f"ARG {name}=" in text for name in asked)
