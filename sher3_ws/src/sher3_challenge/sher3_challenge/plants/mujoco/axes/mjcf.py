"""MuJoCo's XML of the axes: bodies on joints, coupled by tendons. Everything an axis is made of shows here.

Semi-implicit Euler with implicit damping (`implicitfast`) at a tenth of the control period, made second order by hand:
damping acts at the end of a step, as if half a step of it were added to the mass, so that much is taken off; positions
are half a step ahead of the speeds, so they are read half a step back. On moves with steps of the demand the forces are
within 0.5 mN rms of the exact solution of the contract's section 3; at a fifth of the period within 1 mN. Bodies on
stiff springs, not the drives, ask for the shorter step.
"""

from __future__ import annotations

from collections.abc import Iterable

from sher3_challenge.plants.mujoco.axes.parts import ELEMENTS, RUBBER_SOFT, Axis, Bristle

SUBSTEPS = 10
OPTIONS = """<option timestep="{step}" integrator="implicitfast" cone="elliptic" impratio="1e4">
  <flag island="disable" energy="disable" sensor="disable"/></option>"""
RUB = 'solreffriction="{hard} 1" solimpfriction="0.9999 0.9999 1e-3"'
"""Dry friction, as hard as MuJoCo allows: what sticks creeps at 2e-8 s times force over mass. The default's softness
lets a light body that a bristle holds slip back within a tenth of a second.
"""
CONTACT = (0.9, 0.98)
"""MuJoCo's impedance of a contact at its edge and deep in it."""
SOFT = 0.06
"""Share of a gap's width by which its friction presses a body into either side."""
SPACING = 10.0  # m between axes, so that nothing of one meets another


def body(name: str, kind: str, mass: float, joint: str, inside: str = "", place: float = 0.0) -> str:
    """Return a body that gravity leaves alone, on a vertical slide or, for roll, on a hinge along x."""
    axis = '"hinge" axis="1 0 0"' if kind == "revolute" else '"slide" axis="0 0 1"'
    inertia = mass if kind == "revolute" else 1e-7
    weight = 1e-6 if kind == "revolute" else mass
    return (
        f'<body pos="{place} 0 0" gravcomp="1"><joint name="{name}" type={axis} {joint}/>'
        f'<inertial pos="0 0 0" mass="{weight:.15g}" diaginertia="{inertia:.15g} {inertia:.15g} {inertia:.15g}"/>'
        f"{inside}</body>"
    )


def tendon(parts: Iterable[tuple[str, float]], settings: str) -> str:
    """Return a fixed tendon: a linear combination of joint positions with a spring, a limit or friction."""
    joints = "".join(f'<joint joint="{name}" coef="{share:.15g}"/>' for name, share in parts)
    return f"<fixed {settings}>{joints}</fixed>"


def axis_elements(j: int, axis: Axis, step: float) -> tuple[str, str]:
    """Return the bodies and the tendons of axis `j`."""
    bodies, tendons = _motor_side(j, axis, step), ""
    for part in (_load_side(j, axis, step), _dragged(j, axis, step)):
        bodies, tendons = bodies + part[0], tendons + part[1]
    if axis.spring > 0.0:
        spring = f'stiffness="{axis.spring:.15g}" springlength="{axis.spring_rest:.15g}"'
        tendons += tendon([(f"m{j}", 1.0)], spring)
    return bodies + "".join(r.ground for r in axis.riders), tendons + "".join(r.tendons for r in axis.riders)


def _motor_side(j: int, axis: Axis, step: float) -> str:
    carried = "".join(r.carried for r in axis.riders) + (_payload(axis) if axis.payload > 0.0 else "")
    servo = axis.torque_gain * axis.kp
    if axis.drive is not None:  # a law is called at the start of a step: half a step late, not early
        servo *= -1.0 if axis.drive.lag == 0.0 else 0.0
    mass = (1 - axis.load_share if axis.heavy else 1.0) * axis.mass - 0.5 * step * (axis.viscous + servo)
    joint = f'damping="{axis.viscous:.15g}" frictionloss="{axis.coulomb or 1e-9:.15g}" {RUB.format(hard=2 * step)}'
    return body(f"m{j}", axis.kind, mass, joint, carried, SPACING * j)


def _load_side(j: int, axis: Axis, step: float) -> tuple[str, str]:
    """Return the load behind its springs, or dragged through a gap; then the leg behind another gap."""
    held, place = f'frictionloss="{axis.rub:.15g}" {RUB.format(hard=2 * step)}', SPACING * j
    bodies = tendons = ""
    load, ratio = f"m{j}", 1 + axis.lead_error
    if axis.heavy:
        load, mass = f"l{j}", axis.load_share * axis.mass
        bodies, tendons = body(load, axis.kind, mass, "", place=place), _springs(j, axis, mass, ratio)
        if axis.rubber > 0.0:
            bodies += body(f"r{j}", axis.kind, 2e-3 * axis.mass, "", place=place)
    elif axis.gap > 0.0:
        load = f"l{j}"
        bodies = body(load, axis.kind, axis.feather, held, place=place)
        tendons = tendon([(f"m{j}", ratio), (load, -1.0)], _play(axis, axis.gap, step))
    if axis.leg_gap > 0.0:
        bodies += body(f"g{j}", axis.kind, axis.feather, held, place=place)
        tendons += tendon([(load, 1.0), (f"g{j}", -1.0)], _play(axis, axis.leg_gap, step))
    return bodies, tendons


def _dragged(j: int, axis: Axis, step: float) -> tuple[str, str]:
    """Return the bodies that bristles drag over rough ground; those of gradual lost motion are hardly felt."""
    bristles = list(axis.bristles)
    if axis.windup > 0.0:
        bristles += [Bristle(part * 0.3 * axis.rub, reach * axis.windup_reach) for part, reach in ELEMENTS]
    bodies = tendons = ""
    for i, bristle in enumerate(bristles):
        stiffness = bristle.force / bristle.reach
        mass = stiffness * (2 * step) ** 2  # the lightest that such a spring moves with this step
        rough = f'frictionloss="{bristle.force:.15g}" {RUB.format(hard=2 * step)}'
        spring = f'stiffness="{stiffness:.15g}" damping="{0.4 * (stiffness * mass) ** 0.5:.15g}"'
        bodies += body(f"b{j}_{i}", axis.kind, mass, rough, place=SPACING * j)
        tendons += tendon([(f"m{j}", 1.0), (f"b{j}_{i}", -1.0)], spring)
    return bodies, tendons


def _payload(axis: Axis) -> str:
    floats = 0 if axis.hangs else 1
    inertia = axis.payload if axis.kind == "revolute" else 1e-6
    mass = 1e-6 if axis.kind == "revolute" else axis.payload
    return (
        f'<body gravcomp="{floats}"><inertial pos="0 0 0" mass="{mass:.15g}" '
        f'diaginertia="{inertia:.15g} {inertia:.15g} {inertia:.15g}"/></body>'
    )


def _play(axis: Axis, width: float, step: float) -> str:
    """A limit that gives way by MuJoCo's own contact, harder further in; with the body's friction `width` is lost.

    The contact holds a force F on a mass m at the depth (1 - d) F / (d k m), with k = 1 / (dmax time)^2: `time` is
    chosen so that the friction presses the body in by the share SOFT of the width.
    """
    pressed, (edge, deep) = axis.rub / axis.feather * (1 - CONTACT[0]) / CONTACT[0], CONTACT
    time = max(2 * step, (SOFT * width / pressed) ** 0.5 / deep)
    half = max(0.5 * width - pressed * (deep * time) ** 2, 0.05 * width)
    return (
        f'limited="true" range="{-half:.15g} {half:.15g}" solreflimit="{time:.15g} 1" '
        f'solimplimit="{edge} {deep} {4 * SOFT * width:.15g}"'
    )


def _springs(j: int, axis: Axis, mass: float, ratio: float) -> str:
    """Return the springs that carry the load: steel, slack within a gap, or rubber, which is two of them in series."""

    def spring(one: str, share: float, other: str, stiffness: float, damping: float, slack: float = 0.0) -> str:
        rest = f'springlength="{-0.5 * slack:.15g} {0.5 * slack:.15g}"' if slack > 0.0 else 'springlength="0"'
        return tendon([(one, share), (other, -1.0)], f'stiffness="{stiffness:.15g}" damping="{damping:.15g}" {rest}')

    out = ""
    if axis.compliance > 0.0:
        stiffness = 1 / axis.compliance
        out += spring(f"m{j}", ratio, f"l{j}", stiffness, 0.1 * (stiffness * mass) ** 0.5, axis.gap)
    if axis.rubber > 0.0:
        hard, soft = 1 / ((1 - RUBBER_SOFT) * axis.rubber), 1 / (RUBBER_SOFT * axis.rubber)
        out += spring(f"m{j}", ratio, f"r{j}", hard, 0.1 * (hard * mass) ** 0.5)
        out += spring(f"r{j}", 1.0, f"l{j}", soft, soft * axis.rubber_time)
    return out


def drive_elements(j: int, axis: Axis, step: float) -> str:
    """Return the actuators: kp on the demand, and MuJoCo's integrated velocity servo for the rest; or one for a law.

    Half a step of the integral acts with the proportional part: it is the integral in the middle of the step.
    """
    if axis.drive is not None:
        return f'<motor name="f{j}" joint="m{j}"/>'
    kp, ki = axis.torque_gain * axis.kp, axis.torque_gain * axis.ki
    return (
        f'<general name="p{j}" joint="m{j}" gainprm="{kp + 0.5 * step * ki:.15g}" biastype="none"/>'
        f'<general name="i{j}" joint="m{j}" dyntype="integrator" gainprm="{ki:.15g}" biastype="affine" '
        f'biasprm="0 {-ki:.15g} {-kp:.15g}"/>'
    )


def mjcf(axes: list[Axis], period: float) -> str:
    """Return the model of the axes as MuJoCo's XML."""
    step = period / SUBSTEPS
    bodies, tendons = map("".join, zip(*(axis_elements(j, axis, step) for j, axis in enumerate(axes)), strict=True))
    actuators = "".join(drive_elements(j, axis, step) for j, axis in enumerate(axes))
    return (
        f'<mujoco model="sher3_axes"><compiler angle="radian" autolimits="true" boundmass="0"/>'
        f"{OPTIONS.format(step=step)}<worldbody>{bodies}</worldbody>"
        f"<tendon>{tendons}</tendon><actuator>{actuators}</actuator></mujoco>"
    )
