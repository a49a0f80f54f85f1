"""Faults of host, transport, drive and encoders."""

from __future__ import annotations

import math
import operator
from dataclasses import replace

from sher3_challenge.plants.kinds import Catalogue, scaled_by, set_to
from sher3_challenge.plants.mujoco.axes.parts import Drive
from sher3_challenge.plants.mujoco.axes.wheels import Eccentric
from sher3_challenge.plants.mujoco.rig import Rig
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
known = CATALOGUE.known

CATALOGUE.changes(
    operator.add,
    command_delay="host.delay",
    axis_skew="host.delay",
    encoder_scale="host.encoder_scale",
    encoder_offset="host.offset",
)
CATALOGUE.changes(scaled_by, controller_gain="host.gain")
CATALOGUE.changes(set_to, command_jitter="host.jitter", dropped_commands="host.loss", velocity_deadband="axes.deadband")


@known
def drive_lag(rig: Rig, site: Site, time_constant: float) -> None:
    """The force follows through two poles that together delay slow changes by `time_constant`."""
    axis = rig.axes[site.index]
    axis.drive = replace(axis.drive or Drive(), lag=time_constant)


@known
def force_saturation(rig: Rig, site: Site, limit: float) -> None:
    """The force ends at a share of 12 N, of 0.3 N m on roll."""
    axis = rig.axes[site.index]
    axis.drive = replace(axis.drive or Drive(), limit=limit)


@known
def encoder_eccentricity(rig: Rig, site: Site, amplitude: float) -> None:
    """The encoder's disc turns off its centre; the load does not move."""
    lead = rig.axes[site.index].lead
    rig.host.discs[site.index] = Eccentric(amplitude, lead, float(site.rng.uniform(0, 2 * math.pi)))
