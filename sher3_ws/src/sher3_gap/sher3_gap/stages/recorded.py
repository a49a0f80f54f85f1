"""All recorded quantities of a run that the law of an unknown gap might depend on, with units and names."""

from __future__ import annotations

import numpy as np
from sher3_description import ACTUATORS
from sher3_description.contract import REFERENCE_TEMPERATURE
from sher3_diagnosis.channel import Array, Channel
from sher3_diagnosis.discover.feature import Quantities, Quantity
from sher3_effects.view import RobotView

from sher3_gap.signals import RunSignals
from sher3_gap.stages.units import ROTARY_AXES

AXES = "xyz"


def recorded_at(view: RobotView, channel: Channel) -> Quantities:
    """Return the quantities for a channel: name -> values at every tick.

    The own ones of an actuator have plain names, those of others the actuator's before a point. The reported effort is
    none where it is the output: what is left of it explains itself.
    """
    return _axis_quantities(view, channel) if channel.actuator in ACTUATORS else _tip_quantities(view)


def _axis_quantities(view: RobotView, channel: Channel) -> dict[str, Quantity]:
    place = channel.actuator
    out = motion_of(view.run, place, "", True)
    i, run = ACTUATORS.index(place), view.run
    force, unit = _ticks(view, view.inertial), "N*m" if place in ROTARY_AXES else "N"
    load = _ticks(view, view.path.gravity - view.path.contact_force)
    out["force"] = Quantity(force[:, i], unit, "the force that the motion needs", "force")
    out["load"] = Quantity(load[:, i], unit, "the load on the axis", "force")
    if run.echo is not None:
        out["demand"] = Quantity(run.echo[:, i], speed_unit(place), "the demanded velocity", "speed")
    if run.effort is not None and run.echo is not None and channel.stage == "drive":
        law = view.law[:, i]  # but for the integrator's start, which the run's mean effort tells
        asked = law + float(np.mean(run.effort[:, i] - law))
        out["law"] = Quantity(asked, unit, "the force that the drive's law asks for", "force")
    if run.effort is not None and channel.stage == "transmission":
        out["effort"] = Quantity(run.effort[:, i], unit, "the effort of the drive", "force")
    out |= shared_by_all(view.run)
    limit = np.array([a.drive.limit for a in view.robot.actuators])
    work = np.abs(force / limit).sum(axis=1)
    out["work"] = Quantity(work, "1", "the work of all drives together", "state", False)
    for j, name in enumerate(ACTUATORS):
        if j != i:
            out |= motion_of(run, name, f"{name}.", False)
    return out


def motion_of(run: RunSignals, name: str, prefix: str, own: bool) -> dict[str, Quantity]:
    """Return position, velocity and acceleration of an axis, their names behind a prefix."""
    i = ACTUATORS.index(name)
    unit, of = "rad" if name in ROTARY_AXES else "m", "" if own else f" of {name}"
    position, velocity = run.smooth[:, i], run.velocity[:, i]
    acceleration = np.gradient(velocity, run.period)
    return {
        f"{prefix}position": Quantity(position, unit, f"the position{of}", "place", own),
        f"{prefix}velocity": Quantity(velocity, f"{unit}/s", f"the velocity{of}", "speed", own),
        f"{prefix}acceleration": Quantity(acceleration, f"{unit}/s^2", f"the acceleration{of}", "state", own),
    }


def speed_unit(name: str) -> str:
    """Return the unit of an axis' velocity."""
    return "rad/s" if name in ROTARY_AXES else "m/s"


def shared_by_all(run: RunSignals) -> dict[str, Quantity]:
    """Return time and temperature."""
    out = {"time": Quantity(run.stage_clock, "s", "the time since the run began", "clock")}
    if run.temperature is not None:
        warmth = run.temperature - REFERENCE_TEMPERATURE
        out["warmth"] = Quantity(warmth, "K", "the temperature above 22 degrees", "state")
    return out


def _tip_quantities(view: RobotView) -> dict[str, Quantity]:
    """Return postures, loads and motion of the tip; directions of the tool are those of its axes in the base frame."""
    run, path = view.run, view.path
    out = shared_by_all(run)
    rotation, touch = _ticks(view, path.rotation.reshape(-1, 9)), _ticks(view, path.contact)
    position = _ticks(view, path.position)
    inside = np.einsum("nji,nj->ni", rotation.reshape(-1, 3, 3), touch)
    velocity = np.gradient(position, run.period, axis=0)
    for k, a in enumerate(AXES):
        out[f"tip.{a}"] = Quantity(position[:, k], "m", f"the tip's {a}", "place")
        out[f"contact.{a}"] = Quantity(touch[:, k], "N", f"the load along {a}", "force")
        out[f"touch.{a}"] = Quantity(inside[:, k], "N", f"the load along the tool's {a}", "force")
        out[f"speed.{a}"] = Quantity(velocity[:, k], "m/s", f"the tip's velocity along {a}", "speed")
        out[f"push.{a}"] = Quantity(view.tip_acceleration[:, k], "m/s^2", f"the tip's acceleration along {a}", "state")
        for m, b in enumerate(AXES):
            words = f"the {a} part of the tool's {b} axis"
            out[f"tool.{a}{b}"] = Quantity(rotation[:, 3 * k + m], "1", words, "state")
    for i, name in enumerate(ACTUATORS):
        unit = "rad" if name in ROTARY_AXES else "m"
        q = (run.smooth if run.smooth_load is None else run.smooth_load)[:, i]
        out[f"{name}.position"] = Quantity(q, unit, f"the position of {name}", "place", False)
        out[f"{name}.velocity"] = Quantity(run.velocity[:, i], f"{unit}/s", f"the velocity of {name}", "speed", False)
    return out


def _ticks(view: RobotView, x: Array) -> Array:
    """Bring (g, k) values of the residual grid to every tick, (n, k)."""
    clock = view.run.stage_clock
    return np.stack([np.interp(clock, clock[view.run.grid], c) for c in x.T], axis=1)
