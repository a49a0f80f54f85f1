"""The foot pedal as a velocity factor from 0 to 1, with dead band and hysteresis."""

from .compiled import compiled


@compiled
def pedal_pressed(travel: float, was_pressed: bool, press: float, release: float) -> bool:
    """Return whether the pedal counts as pressed; between `release` and `press` [1] it keeps its former state."""
    if was_pressed:
        return travel > release
    return travel >= press


@compiled
def pedal_factor(travel: float, pressed: bool, release: float, binary: bool) -> float:
    """Return the velocity factor: 0 when released, else 1 (binary) or the travel beyond the dead band (proportional).

    Monotone in the travel and continuous above the dead band; 1 at full travel.
    """
    if not pressed:
        return 0.0
    if binary:
        return 1.0
    return (travel - release) / (1.0 - release)
