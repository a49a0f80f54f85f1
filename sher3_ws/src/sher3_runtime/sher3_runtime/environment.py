"""The environment of the middleware, set without importing it: loopback by default."""

from __future__ import annotations

import os
import sys
from pathlib import Path

LOOPBACK_PROFILE = Path(__file__).with_name("loopback.xml")
_GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def graph_environment(domain: int | None = None, other_hosts: bool = False) -> dict[str, str]:
    """Return the environment variables of a graph; nothing leaves the machine unless `other_hosts` is set.

    Args:
        domain: ROS domain id, 0 to 232; None keeps that of the caller's environment.
        other_hosts: Announce this graph to other machines on the subnet and talk to them.
    """
    variables = {
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
        # LOCALHOST would make the middleware replace the profile's transport by one with sockets on every interface.
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET" if other_hosts else "SYSTEM_DEFAULT",
        "FASTRTPS_DEFAULT_PROFILES_FILE": "" if other_hosts else str(LOOPBACK_PROFILE),
        "FASTDDS_DEFAULT_PROFILES_FILE": "" if other_hosts else str(LOOPBACK_PROFILE),
        "AMENT_PREFIX_PATH": os.environ.get("AMENT_PREFIX_PATH") or sys.prefix,
        "RCUTILS_LOGGING_USE_STDOUT": "0",
    }
    if domain is not None:
        variables["ROS_DOMAIN_ID"] = str(domain)
    return variables


def apply(domain: int | None = None, other_hosts: bool = False) -> None:
    """Set the variables of `graph_environment` in this process, before `rclpy.init`."""
    os.environ.update(graph_environment(domain, other_hosts))


def child_environment(**changes: str) -> dict[str, str]:
    """Return this process's environment for a child Python.

    The start-up hook of the ROS wheels executes Python a second time to set `LD_LIBRARY_PATH`, and marks that with a
    guard variable. A child that gets the guard without the path cannot import rclpy, so it gets both or neither.
    """
    variables = {**os.environ, **changes}
    if _GUARD in variables and "LD_LIBRARY_PATH" not in variables:
        del variables[_GUARD]
    return variables
