"""Faults of host, transport, drive and encoders."""

from __future__ import annotations

import math
from dataclasses import replace

from sher3_challenge.plants.kinds import Catalogue
from sher3_challenge.plants.mujoco.axes.parts import Drive
from sher3_challenge.plants.mujoco.axes.wheels import Eccentric
from sher3_challenge.plants.mujoco.rig import Rig
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
known = CATALOGUE.known


@known
def command_delay(rig: Rig, site: Site, delay: float) -> None:
    """Every command arrives later."""
    rig.host.delay += delay


@known
def command_jitter(rig: Rig, site: Site, sigma: float) -> None:
    """Commands arrive late by a half-normal time."""
    rig.host.jitter = sigma


@known
def dropped_commands(rig: Rig, site: Site, probability: float) -> None:
    """Some commands never arrive; the drive holds the one before."""
    rig.host.loss = probability


@known
def axis_skew(rig: Rig, site: Site, skew: float) -> None:
    """Commands of one axis arrive later than those of the others."""
    rig.host.delay[site.index] += skew


@known
def drive_lag(rig: Rig, site: Site, time_constant: float) -> None:
    """The force follows through two poles that together delay slow changes by `time_constant`."""
    axis = rig.axes[site.index]
    axis.drive = replace(axis.drive or Drive(), lag=time_constant)


@known
def controller_gain(rig: Rig, site: Site, relative: float) -> None:
    """The host works with another position gain."""
    rig.host.gain[site.rows] *= 1 + relative


@known
def force_saturation(rig: Rig, site: Site, limit: float) -> None:
    """The force ends at a share of 12 N, of 0.3 N m on roll."""
    axis = rig.axes[site.index]
    axis.drive = replace(axis.drive or Drive(), limit=limit)


@known
def velocity_deadband(rig: Rig, site: Site, width: float) -> None:
    """Demands below a width do nothing."""
    rig.axes[site.index].deadband = width


@known
def encoder_scale(rig: Rig, site: Site, relative: float) -> None:
    """The load encoder's ratio is off."""
    rig.host.encoder_scale[site.rows] += relative


@known
def encoder_eccentricity(rig: Rig, site: Site, amplitude: float) -> None:
    """The encoder's disc turns off its centre; the load does not move."""
    lead = rig.axes[site.index].lead
    rig.host.discs[site.index] = Eccentric(amplitude, lead, float(site.rng.uniform(0, 2 * math.pi)))


@known
def encoder_offset(rig: Rig, site: Site, offset: float) -> None:
    """The axis was homed wrongly: both encoders read too much or too little."""
    rig.host.offset[site.rows] += offset
