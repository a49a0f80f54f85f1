"""Experiments that tell rivals apart: designed, rehearsed in the simulator, and judged by what they separated."""
