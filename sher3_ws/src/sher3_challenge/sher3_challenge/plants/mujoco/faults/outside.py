"""Faults no catalogue names, of the kind MuJoCo makes natural: contacts, tendons, loose bodies, coupled axes."""

from __future__ import annotations

import math
from dataclasses import replace

from sher3_description import ACTUATORS
from sher3_description.contract import GRAVITY

from sher3_challenge.plants.declared import SLIDERS, TIP
from sher3_challenge.plants.kinds import Catalogue
from sher3_challenge.plants.mujoco.axes.laws import Magnet
from sher3_challenge.plants.mujoco.axes.mjcf import SPACING, body, tendon
from sher3_challenge.plants.mujoco.axes.parts import Drive, Rider
from sher3_challenge.plants.mujoco.rig import Rig, Spring
from sher3_challenge.plants.site import Site

CATALOGUE = Catalogue()
add = CATALOGUE.add
FRICTION = ("coulomb_friction", "position_friction")


def add_rider(rig: Rig, site: Site, rider: Rider) -> None:
    """Put a rider on the axis on which the fault sits."""
    rig.axes[site.index].riders += (rider,)


def place(rig: Rig, site: Site, spread: float) -> float:
    """Return a place where the runs work, within `spread` of a slider's travel of their middle."""
    return float(rig.region[site.index] + site.scaled(float(site.rng.uniform(-spread, spread)), "length"))


@add("outside", "motor_mechanics", SLIDERS, 0.5, 0.02, 8.0, company=FRICTION)
def wedge_contact(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A sprung roller that does not turn rubs along a plate that is not parallel to the rail: a cone of friction."""
    j, slope, push = site.index, float(site.rng.choice([-1, 1]) * site.rng.uniform(0.15, 0.3)), 4 * x
    carried = (
        f'<body pos="0 0 0" gravcomp="1"><joint name="wedge{j}" type="slide" axis="1 0 0" '
        f'stiffness="{push / 2e-3:.15g}" springref="2e-3" damping="{0.2 * math.sqrt(push / 2e-3 * 0.02):.15g}"/>'
        f'<geom type="sphere" size="4e-3" mass="0.02" condim="3" friction="0.25 1e-4 1e-5" solref="2e-3 1" '
        f'contype="2" conaffinity="0"/></body>'
    )
    ground = (
        f'<geom type="box" size="1e-2 0.05 0.08" euler="0 {slope:.15g} 0" contype="0" conaffinity="2" '
        f'pos="{SPACING * j + 14e-3 / math.cos(slope):.15g} 0 {rig.region[j]:.15g}" friction="0.25 1e-4 1e-5"/>'
    )
    add_rider(rig, site, Rider(carried=carried, ground=ground))
    return {"force": push, "friction": 0.25, "slope": slope}


@add("outside", "motor_mechanics", SLIDERS, 0.5, 0.02, 8.0)
def toggle_spring(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A tendon across the travel pulls towards its middle, nearly as hard close to it as far from it."""
    j, offset = site.index, float(site.rng.uniform(0.2e-3, 0.5e-3))
    middle = place(rig, site, 0.4e-3)
    # the tendon's other end is 20 mm away, so that its pull hardly depends on the travel
    ground = "".join(
        f'<site name="{name}{j}" pos="{SPACING * j + at:.15g} 0 {middle:.15g}"/>'
        for name, at in (("post", offset), ("end", offset + 20e-3))
    )
    carried = f'<site name="eye{j}" pos="0 0 0"/>'
    tendons = (
        f'<spatial stiffness="{x / 20e-3:.15g}" springlength="0">'
        f'<site site="eye{j}"/><site site="post{j}"/><site site="end{j}"/></spatial>'
    )
    add_rider(rig, site, Rider(carried, ground, tendons))
    return {"force": x, "offset": offset}


@add("outside", "motor_mechanics", ACTUATORS, 0.8, 0.05, 8.0, company=("payload_mass",))
def loose_counterweight(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A balanced mass slides in a tube on the axis and knocks at its ends."""
    j, mass, axis = site.index, site.scaled(x, "inertia"), rig.axes[site.index]
    half = site.scaled(float(site.rng.uniform(0.1e-3, 0.4e-3)), "length")
    joint = f'range="{-half:.15g} {half:.15g}" frictionloss="{0.02 * mass:.15g}" solreflimit="2e-3 0.5"'
    add_rider(rig, site, Rider(body(f"tube{j}", axis.kind, mass, joint)))
    return {"mass": mass, "play": 2 * half}


@add("outside", "motor_mechanics", ("roll",), 2.0, 0.05, 60.0, company=("viscous_friction",))
def swinging_hose(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A hose that hangs on the roll axis is taken along by its stiff grease, swings and comes back."""
    torque, time = site.scaled(x, "force") * 4, float(site.rng.uniform(0.08, 0.25))
    mass = torque / (GRAVITY * 0.1)
    ground = (
        f'<body pos="{SPACING * site.index} 0 0"><joint name="hose" type="hinge" axis="1 0 0"/>'
        f'<inertial pos="0 0 -0.1" mass="{mass:.15g}" diaginertia="1e-7 1e-7 1e-7"/></body>'
    )
    tendons = tendon([(f"m{site.index}", 1.0), ("hose", -1.0)], f'damping="{torque * time:.15g}"')
    add_rider(rig, site, Rider(ground=ground, tendons=tendons))
    return {"torque": torque, "time": time}


@add("outside", "motor_mechanics", ACTUATORS, 0.1, 0.005, 12.0, company=("cable_drag",))
def bumper_hose(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A hose lies in the way from a place on, and stiffens as it is pressed: nothing on the other side."""
    at, reach = place(rig, site, 0.3e-3), site.scaled(0.4e-3, "length")
    stiffness, joint = site.scaled(x, "force") / reach, [(f"m{site.index}", 1.0)]
    free = site.scaled(1.0, "length")
    tendons = "".join(
        tendon(joint, f'stiffness="{stiffness:.15g}" springlength="{-free:.15g} {at + step * reach:.15g}"')
        for step in (0.0, 0.5, 1.0)
    )
    add_rider(rig, site, Rider(tendons=tendons))
    return {"stiffness": stiffness, "place": at}


@add("outside", "motor_mechanics", ACTUATORS, 0.5, 0.02, 8.0, company=("cogging",))
def magnet_latch(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A latch magnet beside the rail pulls towards its place, and is not felt far from it."""
    force = site.scaled(x, "force")
    magnet = Magnet(force, place(rig, site, 0.3e-3), site.scaled(float(site.rng.uniform(0.15e-3, 0.4e-3)), "length"))
    rig.axes[site.index].pushes += (magnet,)
    return {"force": force, "reach": magnet.reach}


@add("outside", "motor_mechanics", ACTUATORS, 0.05, 0.002, 3.0, company=("torque_constant",))
def hot_motor(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The motor heats with the square of its force and loses force as it does; the drive does not know."""
    cooling = float(site.rng.uniform(1.0, 3.0))
    rated = 0.5 if site.actuator == "roll" else 4.0
    axis = rig.axes[site.index]
    axis.drive = replace(axis.drive or Drive(), droop=x, cooling=cooling, rated=rated)
    return {"droop": x, "time_constant": cooling}


@add("outside", "motor_mechanics", SLIDERS, 0.5, 0.02, 12.0)
def tied_axes(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A tendon ties the axis to another one: it pulls when the two move apart."""
    j = site.index
    other = int(site.rng.choice([k for k in (0, 1, 2, 4) if k != j]))
    share = float(site.rng.choice([-1.0, 1.0]))
    length = rig.region[j] - share * rig.region[other]
    stiffness = x / 1e-3
    parts = [(f"m{j}", 1.0), (f"m{other}", -share)]
    settings = f'stiffness="{stiffness:.15g}" damping="{0.02 * stiffness:.15g}" springlength="{length:.15g}"'
    add_rider(rig, site, Rider(tendons=tendon(parts, settings)))
    return {"stiffness": stiffness}


@add("outside", "transmission", SLIDERS, 1e-6, 5e-8, 1.2e-5, company=("transmission_compliance",))
def rubber_coupling(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """A coupling that gives way a little at once and the rest within tenths of a second."""
    axis = rig.axes[site.index]
    axis.rubber, axis.rubber_time = x, float(site.rng.uniform(0.15, 0.5))
    return {"compliance": x, "time": axis.rubber_time}


@add("outside", "sensing", ACTUATORS, 2e-6, 5e-8, 1e-4, also=("transmission",))
def loose_read_head(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The load encoder's head hangs on a leaf spring and swings when the axis accelerates."""
    j, axis, frequency = site.index, rig.axes[site.index], float(site.rng.uniform(14.0, 35.0))
    unit, omega = 2e-3 * axis.mass, 2 * math.pi * frequency
    joint = f'stiffness="{unit * omega**2:.15g}" damping="{0.06 * unit * omega:.15g}"'
    # under one metre per second squared the head stands x off
    add_rider(rig, site, Rider(body(f"head{j}", axis.kind, unit, joint), read=((f"head{j}", x * omega**2),)))
    return {"displacement": x, "frequency": frequency}


@add("outside", "structure", TIP, 2e-5, 1e-6, 8e-4, company=("tool_bending",))
def tool_clamp_slip(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The tool slips in its clamp once a load exceeds the clamp's friction, and does not come all the way back."""
    hold = float(site.rng.uniform(0.2, 0.5))
    ways = ("across_x", "across_y")
    rig.yielding.springs += tuple(Spring(way, x, 15.0, 1.0, rub=hold) for way in ways)
    return {"compliance": x, "friction": hold}


@add("outside", "transport", ACTUATORS, 2.0, 2.0, 4.0, company=("command_delay", "axis_skew"))
def sampled_demand(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The drive looks for a demand only at every second, third or fourth tick."""
    rig.host.hold[site.rows] = round(x)
    return {"ticks": float(round(x))}


@add("outside", "controller", ACTUATORS, 4e-3, 5e-4, 3e-2, company=("command_delay",))
def smoothed_command(rig: Rig, site: Site, x: float) -> dict[str, float]:
    """The host sends its command through a first-order filter."""
    rig.host.smoothing[site.rows] = x
    return {"time_constant": x}
