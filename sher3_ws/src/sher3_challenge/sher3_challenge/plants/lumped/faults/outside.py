"""Faults no catalogue names: the right answer to them is that the library does not explain the gap."""

from __future__ import annotations

from sher3_description import ACTUATORS

from sher3_challenge.plants.declared import FORCE_SENSOR, SLIDERS, TIP
from sher3_challenge.plants.kinds import Catalogue
from sher3_challenge.plants.lumped.rig import Rig
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
add = CATALOGUE.add


@add("outside", "drive", ACTUATORS, 0.2, 0.01, 8.0)
def drive_hum(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The current oscillates at a fixed frequency."""
    rig.truth.drive.hum[site.rows] = site.scaled(x, "force")
    rig.truth.drive.hum_frequency[site.rows] = frequency = site.rng.uniform(7.0, 21.0)
    return {"amplitude": site.scaled(x, "force"), "frequency": frequency}


@add("outside", "drive", ACTUATORS, 0.1, 0.004, 0.8)
def drive_asymmetry(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The drive pushes harder than it pulls."""
    rig.truth.drive.asymmetry[site.rows] = x
    return {"relative": x}


@add("outside", "drive", ACTUATORS, 0.5, 0.02, 20.0)
def integrator_leak(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The drive's integrator forgets."""
    rig.truth.drive.leak[site.rows] = x
    return {"rate": x}


@add("outside", "motor_mechanics", ACTUATORS, 0.3, 0.01, 3.0, company=("torque_constant", "viscous_friction"))
def torque_loss(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Force is lost above a speed."""
    rig.truth.motor.loss[site.rows] = x
    rig.truth.motor.loss_velocity[site.rows] = site.scaled(3e-3, "speed") * (0.5 if site.actuator == "roll" else 1)
    return {"relative": x}


@add("outside", "motor_mechanics", ACTUATORS, 1.0, 0.05, 8.0)
def mass_wave(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The moving mass depends on position."""
    rig.truth.motor.mass_wave[site.rows] = site.scaled(x, "inertia")
    rig.truth.motor.mass_period[site.rows] = site.scaled(1.5e-3, "length")
    return {"mass": site.scaled(x, "inertia")}


@add("outside", "motor_mechanics", ACTUATORS, 8e3, 300.0, 4e5, company=("viscous_friction",))
def quadratic_drag(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Drag grows with the square of speed."""
    drag = x * (0.025 / 98**2) if site.actuator == "roll" else x
    rig.truth.motor.quadratic[site.rows] = drag
    return {"coefficient": drag}


@add("outside", "motor_mechanics", ("tilt",), 60.0, 2.0, 1500.0)
def axis_coupling(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """Roll drags the tilt slider along."""
    rig.truth.host.coupling[4, 3] = site.sign() * x / 98
    return {"coefficient": x / 98}


@add("outside", "motor_mechanics", ACTUATORS, 0.8, 0.02, 10.0, company=("coulomb_friction", "position_friction"))
def sticky_region(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The axis sticks in one short region of its stroke."""
    m = rig.truth.motor
    m.sticky[site.rows] = site.scaled(x, "force")
    m.sticky_place[site.rows] = rig.region[site.index] + site.scaled(site.rng.uniform(-0.3e-3, 0.3e-3), "length")
    m.sticky_width[site.rows] = site.scaled(0.15e-3, "length")
    return {"force": site.scaled(x, "force")}


@add("outside", "motor_mechanics", ("all",), 1.0, 0.05, 2.0, company=("torque_constant",))
def supply_sag(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """All drives lose force when they work hard together."""
    rig.truth.host.sag[0] = x
    return {"relative": x}


@add("outside", "transmission", SLIDERS, 2e-6, 1e-7, 3e-4, company=("transmission_compliance",))
def compliance_bump(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The transmission is soft in one short region."""
    t = rig.truth.transmission
    t.bump[site.rows] = x
    t.bump_place[site.rows] = rig.region[site.index] + site.rng.uniform(-0.3e-3, 0.3e-3)
    t.bump_width[site.rows] = 0.3e-3
    return {"compliance": x}


@add("outside", "sensing", ACTUATORS, 2e-6, 3e-7, 1e-4, also=("transmission",))
def encoder_glitch(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The load encoder jumps for single ticks, now and then."""
    rig.truth.host.glitch[site.rows] = size = 4 * site.scaled(x, "length")
    rig.truth.host.glitch_probability[site.rows] = 0.03
    return {"amplitude": size}


@add("outside", "sensing", ACTUATORS, 3e-4, 1e-5, 8e-3, also=("transmission",))
def encoder_lag(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The load encoder answers late and with a little hysteresis."""
    rig.truth.host.encoder_lag[site.rows] = x
    rig.truth.host.encoder_loop[site.rows] = site.scaled(1e-3, "speed") * x
    return {"delay": x}


@add("outside", "mechanism", TIP, 1e-3, 5e-5, 5e-2)
def parasitic_motion(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The tip shifts sideways in proportion to its speed, and up when it moves vertically."""
    rig.truth.geometry.parasitic[:2] = x, 0.6 * x
    return {"coefficient": x}


@add("outside", "sensing", FORCE_SENSOR, 0.02, 1e-3, 1.0)
def force_lag(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The force sensor's electronics answer late."""
    rig.truth.sensors.force_lag[0] = x
    return {"time_constant": x}


@add("outside", "transport", ACTUATORS, 1e-4, 2e-5, 1e-3)
def demand_resolution(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The drive takes demands in coarse steps."""
    rig.truth.host.demand_resolution[site.rows] = site.scaled(x, "speed")
    return {"resolution": site.scaled(x, "speed")}


@add("outside", "transport", ACTUATORS, 2.0, 0.5, 8.0)
def demand_slew(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The drive limits the rate of the demand; a larger `x` is a lower limit, 0.4 m/s^2 over x."""
    rig.truth.host.demand_slew[site.rows] = limit = site.scaled(0.4 / x, "speed")
    return {"limit": limit}


@add("outside", "controller", ACTUATORS, 1.0, 0.99, 1.01, company=("command_delay",))
def stale_feedback(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The host works with the encoder reading of the tick before."""
    rig.truth.host.stale[site.rows] = 1.0
    return {"ticks": 1.0}


@add("outside", "controller", ACTUATORS, 5e-5, 1e-5, 1e-3)
def command_resolution(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The host rounds its commands coarsely."""
    rig.truth.host.command_resolution[site.rows] = site.scaled(x, "speed")
    return {"resolution": site.scaled(x, "speed")}
