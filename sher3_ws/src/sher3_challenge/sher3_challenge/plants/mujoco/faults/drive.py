"""Faults of host, transport, drive and encoders."""

from __future__ import annotations

import math
from dataclasses import replace

from sher3_challenge.plants.kinds import Catalogue, Site
from sher3_challenge.plants.mujoco.axes.parts import Drive
from sher3_challenge.plants.mujoco.axes.wheels import Eccentric
from sher3_challenge.plants.mujoco.rig import Rig

CATALOGUE = Catalogue()
known = CATALOGUE.known


@known
def command_delay(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Every command arrives later."""
    rig.host.delay = rig.host.delay + x
    return {"delay": x}


@known
def command_jitter(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Commands arrive late by a half-normal time."""
    rig.host.jitter = x
    return {"sigma": x}


@known
def dropped_commands(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Some commands never arrive; the drive holds the one before."""
    rig.host.loss = x
    return {"probability": x}


@known
def axis_skew(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Commands of one axis arrive later than those of the others."""
    rig.host.delay = rig.host.delay.copy()
    rig.host.delay[site.index] += x
    return {"skew": x}


@known
def drive_lag(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force follows through two poles that together delay slow changes by `x`."""
    axis = rig.axes[site.index]
    axis.drive = replace(axis.drive or Drive(), lag=x)
    return {"time_constant": x}


@known
def controller_gain(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The host works with another position gain."""
    relative = site.sign() * x
    rig.host.gain = rig.host.gain.copy()
    rig.host.gain[site.rows] *= 1 + relative
    return {"relative": relative}


@known
def force_saturation(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force ends at 12 N / (1 + x), 0.3 N m / (1 + x) on roll."""
    limit = site.scaled(12.0, "force") / (1 + x)
    axis = rig.axes[site.index]
    axis.drive = replace(axis.drive or Drive(), limit=limit)
    return {"limit": limit}


@known
def velocity_deadband(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Demands below a width do nothing."""
    width = site.scaled(x, "speed")
    rig.axes[site.index].deadband = width
    return {"width": width}


@known
def encoder_scale(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The load encoder's ratio is off."""
    relative = site.sign() * x
    rig.host.encoder_scale = rig.host.encoder_scale.copy()
    rig.host.encoder_scale[site.rows] += relative
    return {"relative": relative}


@known
def encoder_eccentricity(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The encoder's disc turns off its centre; the load does not move."""
    amplitude, lead = site.scaled(x, "length"), rig.axes[site.index].lead
    rig.host.discs[site.index] = Eccentric(amplitude, lead, float(site.rng.uniform(0, 2 * math.pi)))
    return {"amplitude": amplitude}


@known
def encoder_offset(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The axis was homed wrongly: both encoders read too much or too little."""
    offset = site.sign() * site.scaled(x, "length")
    rig.host.offset = rig.host.offset.copy()
    rig.host.offset[site.rows] += offset
    return {"offset": offset}
