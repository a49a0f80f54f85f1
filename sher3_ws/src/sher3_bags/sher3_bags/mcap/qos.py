"""Quality of service as rosbag2 writes it (metadata version 9 and MCAP channel metadata)."""

from __future__ import annotations

from functools import cache
from typing import Any

import yaml
from sher3_description import Qos

_FOREVER = {"sec": 9223372036, "nsec": 854775807}


def offered_qos_profiles(qos: Qos) -> list[dict[str, Any]]:
    """Return the list rosbag2 stores for one publisher."""
    return [
        {
            "history": "keep_last",
            "depth": qos.depth,
            "reliability": qos.reliability,
            "durability": qos.durability,
            "deadline": dict(_FOREVER),
            "lifespan": dict(_FOREVER),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(_FOREVER),
            "avoid_ros_namespace_conventions": False,
        }
    ]


@cache
def offered_qos_text(qos: Qos) -> str:
    """Return the same list as YAML, as the metadata of an MCAP channel holds it."""
    return yaml.safe_dump(offered_qos_profiles(qos), sort_keys=False)
