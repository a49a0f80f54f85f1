"""Faults no catalogue names: the right answer to them is that the library does not explain the gap."""

from __future__ import annotations

from sher3_description import ACTUATORS

from sher3_challenge.plants.declared import DELTAS, FORCE_SENSOR, TIP
from sher3_challenge.plants.kinds import Catalogue
from sher3_challenge.plants.site import Site
from sher3_challenge.plants.tables.plant import Rig

CATALOGUE = Catalogue()
add = CATALOGUE.add


def _place(rig: Rig, site: Site) -> float:
    """Return a place of the stroke where the runs go."""
    return float(rig.region[site.index] + site.scaled(site.rng.uniform(-0.25e-3, 0.25e-3), "length"))


@add("outside", "motor_mechanics", ACTUATORS, 0.4, 0.01, 8.0)
def magnetic_detent(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A magnet holds in steps, and its field trails behind the direction of travel."""
    rig.truth.odd.detent[site.rows] = force = site.scaled(x, "force")
    rig.truth.odd.detent_order[site.rows] = site.rng.choice([2.0, 3.0, 5.0])
    return {"force": force}


@add("outside", "motor_mechanics", ACTUATORS, 0.6, 0.02, 10.0, company=("coulomb_friction", "friction_drift"))
def resting_lubricant(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Lubricant sets while the axis rests and is stirred again within a fraction of a millimetre."""
    rig.truth.odd.resting[site.rows] = force = site.scaled(x, "force")
    return {"force": force}


@add("outside", "motor_mechanics", ACTUATORS, 0.8, 0.02, 10.0)
def ploughing(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A wiper gathers grease: friction grows with the travel since the last reversal, for a millimetre."""
    rig.truth.odd.plough[site.rows] = force = site.scaled(x, "force")
    rig.truth.odd.plough_reach[site.rows] = site.scaled(1.2e-3, "length")
    return {"force": force}


@add("outside", "motor_mechanics", ACTUATORS, 1.0, 0.05, 8.0, company=("payload_mass",))
def engaged_mass(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Beyond a place of the stroke the axis takes another mass along."""
    rig.truth.odd.engaged[site.rows] = mass = site.scaled(x, "inertia")
    rig.truth.odd.place[site.rows] = _place(rig, site)
    return {"mass": mass}


@add("outside", "motor_mechanics", ACTUATORS, 0.3, 0.01, 8.0)
def snapping_cable(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A cable snaps over to the other side, later on the way back than on the way out."""
    rig.truth.odd.snap[site.rows] = force = site.scaled(x, "force")
    rig.truth.odd.place[site.rows] = _place(rig, site)
    rig.truth.odd.snap_width[site.rows] = site.scaled(0.15e-3, "length")
    return {"force": force}


@add("outside", "motor_mechanics", ACTUATORS, 0.25, 0.004, 0.7, company=("torque_constant",))
def warm_winding(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force constant falls with the heat of the last seconds' current."""
    rig.truth.odd.heat[site.rows] = x
    return {"relative": x}


@add("outside", "motor_mechanics", ("delta_1", "delta_2", "tilt"), 0.05, 0.002, 0.6)
def magnetic_coupling(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force of the next motor strays into this one."""
    neighbour = {0: 1, 1: 2, 4: 0}[site.index]
    rig.truth.stray[site.index, neighbour] = site.sign() * x
    return {"coefficient": x}


@add("outside", "drive", ACTUATORS, 0.3, 0.01, 4.0)
def crossover(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The amplifier swallows the first newtons on either side of zero force."""
    rig.truth.odd.crossover[site.rows] = force = site.scaled(x, "force")
    return {"force": force}


@add("outside", "drive", ACTUATORS, 0.2, 0.01, 0.8)
def gain_schedule(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The drive's gain falls with speed."""
    rig.truth.odd.schedule[site.rows] = x
    return {"relative": x}


@add("outside", "transmission", ACTUATORS, 3e-6, 1e-7, 1e-4)
def rail_joint(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The load makes a small step where two pieces of its rail meet."""
    rig.truth.odd.joint[site.rows] = step = site.sign() * site.scaled(x, "length")
    rig.truth.odd.place[site.rows] = _place(rig, site)
    rig.truth.odd.joint_width[site.rows] = site.scaled(0.08e-3, "length")
    return {"step": step}


@add("outside", "sensing", ACTUATORS, 5e-7, 5e-8, 8e-6, also=("transmission",))
def interpolation_error(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The load encoder errs within each of its signal periods, twice as often when it is fast."""
    rig.truth.odd.grating[site.rows] = amplitude = site.scaled(x, "length")
    rig.truth.odd.grating_period[site.rows] = site.scaled(90e-6, "length")
    return {"amplitude": amplitude}


@add("outside", "sensing", ACTUATORS, 0.02, 0.002, 0.5, also=("transmission",))
def repeated_reading(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Every so many ticks the load encoder gives its last reading again; `x` is the share of such ticks."""
    rig.truth.odd.repeat[site.rows] = ticks = max(2, round(1 / x))
    return {"ticks": float(ticks)}


@add("outside", "sensing", FORCE_SENSOR, 0.03, 2e-3, 1.0)
def late_channel(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """One channel of the force sensor is filtered more than the others."""
    rig.truth.sensor.late[int(site.rng.integers(3))] = x
    return {"time_constant": x}


@add("outside", "sensing", FORCE_SENSOR, 0.05, 2e-3, 0.8, company=("force_scale",))
def sensor_hysteresis(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force sensor reads less while a force grows and more while it falls."""
    rig.truth.sensor.loop[0] = x
    return {"relative": x}


@add("outside", "mechanism", DELTAS, 2e-6, 1e-7, 3e-4)
def thermal_bow(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A rail bows as it warms: the platform shifts across it, most at one end of the stroke."""
    rig.truth.tip.bow_warm[site.index] = x
    return {"per_kelvin": x}


@add("outside", "mechanism", TIP, 8e-6, 3e-7, 3e-4)
def joint_stiction(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Ball joints stick: the platform shifts across the motion of the first slider, by its direction."""
    rig.truth.tip.stiction[0] = x
    return {"shift": x}


@add("outside", "structure", TIP, 1e-5, 5e-7, 4e-4, company=("tool_bending",))
def slipping_tool(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The tool slips in its holder under a side load and stays there; `x` is the slip per newton."""
    rig.truth.tip.slip[:] = x, 0.35
    return {"compliance": x}


@add("outside", "transport", ACTUATORS, 0.3, 0.05, 0.9, company=("axis_skew",))
def demand_averaging(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The drive takes a mean of the last two commands."""
    rig.truth.odd.average[site.rows] = x
    return {"share": x}


@add("outside", "controller", ACTUATORS, 0.5, 0.1, 0.9, company=("command_delay",))
def filtered_feedback(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The host works with a smoothed reading of the encoder."""
    rig.truth.odd.smoothing[site.rows] = x
    return {"share": x}
