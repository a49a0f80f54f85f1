"""An effort of one axis in another unit than stated, against what its model or its command asks for.

A thousand times too large an effort would pass for a friction and a payload of a thousand times their size.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from sher3_diagnosis.channel import Array

from sher3_chain.axes.view import AxisView
from sher3_chain.joint.description import Axis, Gravity
from sher3_chain.joint.own_unit import OWN_UNITS
from sher3_chain.readings.signals import AxisSignals, held_mean
from sher3_chain.readings.slip_of_unit import share_in
from sher3_chain.thresholds import HEAVIEST, SLIPPED


def slip_of(signals: Sequence[AxisSignals], axis: Axis) -> str | None:
    """Return how far an effort is in another unit than stated, in a sentence; None where it is not, or not known."""
    if axis.signals.effort is None or axis.own_unit or any(s.effort is None for s in signals):
        return None
    views = [AxisView(s, axis, axis.mass if isinstance(axis.mass, float) else 0.0) for s in signals]
    known = isinstance(axis.mass, float) or axis.gravity != Gravity() or axis.signals.nominal_effort is not None
    asked = commands_force(axis) and all(s.command is not None for s in signals)
    for comparable, most, what, force in (
        (known, HEAVIEST, "its model needs", lambda view: view.inertial[:, 0]),
        (asked, SLIPPED, "its command asks for", _commanded),
    ):
        if not comparable:
            continue
        parts = [_equations(view, force(view)) for view in views]
        share = share_in(*(np.concatenate([part[k] for part in parts]) for k in (0, 1)))
        if share.off(most):
            return f"{axis.name}: effort is {share.value:.4g} times what {what}: state its `factor`"
    return None


def commands_force(axis: Axis) -> bool:
    """Return whether the command is known as a force: by its unit, a factor or a gain."""
    source, law = axis.signals.command, axis.command_law
    if source is None or law.kind != "force":
        return False
    return source.factor != 1.0 or law.gain != 1.0 or (source.unit or "1") not in OWN_UNITS


def _commanded(view: AxisView) -> Array:
    """Force (g,) that the command asks for."""
    command, law = view.run.command, view.described.command_law
    assert command is not None
    return view.run.to_grid(law.gain * (held_mean(command) if law.held else command))[:, 0]


def _equations(view: AxisView, force: Array) -> tuple[Array, Array]:
    """Columns (n, 4): a known force, velocity, direction, one; and the recorded effort (n,)."""
    ok, run = view.in_motion, view.run
    assert run.effort is not None
    x = np.column_stack([force, view.velocity[:, 0], view.direction, np.ones(len(force))])
    return x[ok], run.to_grid(run.effort)[ok, 0]
