"""Whether the installed middleware has DDS security (SROS 2): tries to create a node in an enclave, and says why not.

    python tools/dds_security.py [--json]

Exit code 0 when it has, 1 when it lacks it.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

LACKING = "This Fast DDS version doesn't have the security libraries"
NODE = "import rclpy\nrclpy.init(domain_id=76)\nrclpy.create_node('a')\nprint('created')"
FILES = ("identity_ca.cert.pem", "permissions_ca.cert.pem", "cert.pem", "key.pem", "governance.p7s", "permissions.p7s")


def answer() -> str:
    """Return what the middleware says when a node is to live in an enclave (of empty files, so it never succeeds)."""
    from sher3_runtime.environment import child_environment, graph_environment

    with tempfile.TemporaryDirectory() as keystore:
        enclaves = Path(keystore) / "enclaves"
        enclaves.mkdir()
        for name in FILES:
            (enclaves / name).touch()
        security = {"ENABLE": "true", "STRATEGY": "Enforce", "KEYSTORE": keystore}
        variables = {f"ROS_SECURITY_{name}": value for name, value in security.items()}
        environment = child_environment(**graph_environment(), **variables)
        run = subprocess.run([sys.executable, "-c", NODE], env=environment, capture_output=True, text=True, check=False)
    return (run.stderr or run.stdout).strip()


def main() -> None:
    """Ask the middleware and print its answer."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    said = answer()
    lacking = LACKING in said
    line = next((line for line in said.splitlines() if LACKING in line), said[-300:])
    print(json.dumps({"dds_security": not lacking, "middleware": line}) if options.json else line)
    sys.exit(1 if lacking else 0)


if __name__ == "__main__":
    main()
