"""A lift that carries a pendulum, for the tests: a sliding and a turning joint, with efforts worked out by hand."""

import numpy as np
from sher3_chain.joint.record import AxesRun
from sher3_chain.manipulator.description import ManipulatorDescription
from sher3_chain.manipulator.kind import KIND

G, M1, M2, L, I2 = 9.81, 4.0, 2.0, 0.3, 0.01
"""Gravity, masses of lift and pendulum (kg), its length (m) and its inertia about its centre (kg m^2)."""
PERIOD = 0.005

URDF = f"""<robot name="lift">
  <link name="base"/>
  <link name="carriage"><inertial><origin xyz="0 0 0"/><mass value="{M1}"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="pendulum"><inertial><origin xyz="0 0 {-L}"/><mass value="{M2}"/>
    <inertia ixx="{I2}" iyy="{I2}" izz="{I2}" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="lift" type="prismatic"><parent link="base"/><child link="carriage"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="100" velocity="2"/></joint>
  <joint name="swing" type="revolute"><parent link="carriage"/><child link="pendulum"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="100" velocity="5"/></joint>
</robot>"""
MJCF = f"""<mujoco><compiler angle="radian"/><worldbody><body name="carriage">
  <joint name="lift" type="slide" axis="0 0 1"/>
  <inertial pos="0 0 0" mass="{M1}" diaginertia="0.1 0.1 0.1"/>
  <body name="pendulum"><joint name="swing" type="hinge" axis="0 1 0"/>
  <inertial pos="0 0 {-L}" mass="{M2}" diaginertia="{I2} {I2} {I2}"/></body></body></worldbody></mujoco>"""


def motion(seconds=20.0, period=PERIOD, seed=0.0):
    """Position, velocity and acceleration, (n, 2) each."""
    t = np.arange(0.0, seconds, period)
    waves = [[(0.2, 1.1, seed), (0.1, 2.3, 0.4)], [(0.8, 0.9, 0.3 + seed), (0.5, 2.1, 1.0)]]
    q = np.stack([sum(a * np.sin(w * t + p) for a, w, p in joint) for joint in waves], axis=1)
    v = np.stack([sum(a * w * np.cos(w * t + p) for a, w, p in joint) for joint in waves], axis=1)
    return q, v, np.stack([sum(-a * w * w * np.sin(w * t + p) for a, w, p in joint) for joint in waves], axis=1)


def needed(q, v, a, extra=0.0, x=0.0, z=0.0):
    """Forces (n, 2) by Lagrange's equations; a point mass `extra` at (x, 0, z) of the pendulum's frame is carried too.

    A body at (x, z) of the pendulum is at height lift + z cos(th) - x sin(th) and out by z sin(th) + x cos(th).
    """
    lift, th, om = q[:, 0], q[:, 1], v[:, 1]
    force, torque = M1 * (a[:, 0] + G), I2 * a[:, 1]
    for m, px, pz in ((M2, 0.0, -L), (extra, x, z)):
        out, up = pz * np.sin(th) + px * np.cos(th), pz * np.cos(th) - px * np.sin(th)
        height = a[:, 0] - out * a[:, 1] - up * om**2  # second derivative of lift + up, with d up = -out d th
        force = force + m * (height + G)
        torque = torque + m * ((px**2 + pz**2) * a[:, 1] - out * (a[:, 0] + G))
    assert lift.shape == force.shape
    return np.stack([force, torque], axis=1)


def friction(v, coulomb=(0.0, 0.0), viscous=(0.0, 0.0)):
    return np.tanh(v / 1e-3) * coulomb + v * viscous


def run_of(q, effort, period=PERIOD, name="run", noise=0.02, counts=(1e-6, 1e-6)):
    """A record with encoders of some count and efforts with some noise."""
    effort = effort + noise * np.random.default_rng(3).normal(size=effort.shape)
    read = np.array(counts) * np.round(q / np.array(counts))
    return AxesRun(
        name,
        period,
        {j: {"position": read[:, i], "effort": effort[:, i]} for i, j in enumerate(("lift", "swing"))},
    )


def described(path, text=URDF, joint=None, **changes):
    """The lift; `joint` changes fields of its joints."""
    path.write_text(text)
    joints = [
        {
            "name": name,
            "motion": kind,
            "signals": {"position": {"column": "q", "unit": "1"}, "effort": {"column": "e", "unit": "1"}},
            "encoder_resolution": 1e-6,
            "effort_resolution": 0.01,
            **(joint or {}).get(name, {}),
        }
        for name, kind in (("lift", "linear"), ("swing", "rotary"))
    ]
    data = {"kind": "manipulator", "name": "lift", "model": str(path), "time": {"rate": 200.0}, "joints": joints}
    return ManipulatorDescription.model_validate({**data, **changes})


def machine(path, **changes):
    return KIND.machine(described(path, **changes))


def values(verdict):
    return {(c.effect, c.actuator, n): p.value for c in verdict.causes for n, p in c.parameters.items()}
