"""How the nodes of a session kept time, as a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sher3_bags.figures.report import Block

HEADER = ("node [us p50/p99/max]", "period", "wake-up", "tick", "lost", "drops")
_NONE = {"count": 0}


def node_timing(nodes: Mapping[str, Mapping[str, Any]]) -> Block:
    """Return the table of statistics by node, as the nodes leave them when they end."""
    return Block("How the nodes kept time", HEADER, tuple(_row(name, figures) for name, figures in nodes.items()))


def _row(name: str, figures: Mapping[str, Any]) -> tuple[object, ...]:
    spreads = (figures["period"], figures["wakeup"], figures["callback"].get("tick", _NONE))
    return (name, *map(_spread, spreads), figures["lost_cycles"], sum(figures["dropped"].values()))


def _spread(histogram: Mapping[str, float]) -> str:
    return "/".join(f"{histogram[key] / 1e3:.0f}" for key in ("p50", "p99", "max")) if histogram["count"] else "-"
