"""Cost of the control room per tick and the figures of its laws: `python bench/control.py [--json] [--repeat N]`.

Node figures are whole ticks of one node: its callbacks called with decoded samples, publishing into the middleware
with no reader. Law figures are Python calls of the compiled kernels.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from rclpy.context import Context
from sher3_common.operating_state import OperatingState
from sher3_common.samples import JointSample, JoySample, TextSample, TwistSample, WrenchSample
from sher3_control import ControlSettings, LawInput, initial_state, step
from sher3_control.law.parameters import law_parameters
from sher3_control.law.position_controller import position_command
from sher3_control.motion.cooperative import VelocityModes
from sher3_control.motion.pose import tip_pose_sample
from sher3_control.motion.rcm import NO_HOLD, rcm_velocity, shaft_deviation
from sher3_control.nodes.admittance_node import AdmittanceNode
from sher3_control.nodes.kinematics_node import KinematicsNode
from sher3_control.nodes.supervisor_node import SupervisorNode
from sher3_control.supervision.detectors import SilenceDetector
from sher3_description import load_robot
from sher3_kinematics import RobotKinematics
from sher3_runtime import environment
from sher3_runtime.clock import SteppedClock
from sher3_runtime.ports import use_clock
from sher3_sim.plant import Plant

ROBOT = load_robot()
KINEMATICS = RobotKinematics(ROBOT)
PARAMETERS = np.array(KINEMATICS.parameters)
SETTINGS = ControlSettings.from_robot(ROBOT)
REST = (0.0,) * 5
T = 2_000_000
TWIST = (1e-3, -5e-4, 2e-4, 0.01, 0.02, 0.0)


def cost(call: Callable[[int], Any], repeat: int) -> dict[str, float]:
    """Return p50 and p99 of one call [us]; the argument counts the calls."""
    for k in range(200):
        call(k)
    times = np.empty(repeat)
    for k in range(repeat):
        start = time.perf_counter_ns()
        call(200 + k)
        times[k] = time.perf_counter_ns() - start
    p50, p99 = np.percentile(times, [50, 99]) / 1e3
    return {"p50_us": round(float(p50), 2), "p99_us": round(float(p99), 2)}


def law_costs(repeat: int) -> dict[str, dict[str, float]]:
    """Time the pure parts."""
    p, state, z = law_parameters(ROBOT, SETTINGS), initial_state(), (0.0,) * 6
    wrench = (0.5, 0.1, -0.2, 0.001, 0.0, 0.0)

    def law(k: int) -> None:
        nonlocal state
        t = k * T
        i = LawInput(t, True, True, t, (0.5 + 1e-9 * k, *wrench[1:]), t, 0.0 if k == 0 else 1.0, False, t, 0.1, 0.2,
                     1.0, 0.001, 5.0, 0, z)  # fmt: skip
        state, _ = step(state, i, p)

    limit = tuple(a.limits.velocity for a in ROBOT.actuators)
    modes = VelocityModes(KINEMATICS, 10.0)
    about = VelocityModes(KINEMATICS, 10.0)
    about.set_centre(about.centre_behind_tip(0.018, REST), REST)
    return {
        "admittance law": cost(law, repeat),
        "host law": cost(lambda _: position_command(REST, REST, REST, 20.0, limit), repeat),
        "twist to actuators": cost(lambda _: modes.from_twist(REST, TWIST, REST), repeat),
        "twist about a remote centre": cost(lambda _: about.from_twist(REST, TWIST, REST), repeat),
        "tip pose": cost(lambda _: tip_pose_sample(PARAMETERS, REST), repeat),
    }


def node_costs(repeat: int) -> dict[str, dict[str, float]]:
    """Time whole ticks of the nodes."""
    environment.apply()
    context = Context()
    context.init(domain_id=97)
    clock = SteppedClock(T)
    use_clock(context, clock)
    start = clock.start_ns + T
    nodes = {
        "admittance": AdmittanceNode(ROBOT, context=context),
        "kinematics": KinematicsNode(ROBOT, context=context),
        "supervisor": SupervisorNode(ROBOT, context=context),
    }
    try:
        return {f"{name} node, one tick": cost(tick, repeat) for name, tick in _ticks(nodes, start, clock).items()}
    finally:
        for node in nodes.values():
            node.destroy_node()
        context.try_shutdown()


def _ticks(nodes: dict[str, Any], start: int, clock: SteppedClock) -> dict[str, Callable[[int], None]]:
    a, m, s = nodes["admittance"], nodes["kinematics"], nodes["supervisor"]
    silence = [detector for detector in s.supervisor.detectors if isinstance(detector, SilenceDetector)]
    m.motion.cooperative_wants(False, start)
    a.on_motion(TextSample('{"mode": null}'))

    def hear(node: Any, k: int) -> int:
        clock.time_ns = start + k * T
        if k % 400 == 0:
            node.on_state(TextSample(OperatingState.ENABLED.value))
        return clock.time_ns

    def admittance(k: int) -> None:
        t = hear(a, k)
        a.on_joints(JointSample(t, REST))
        a.on_pedal(JoySample(t, (0.0 if k == 0 else 1.0,), (0,)))
        a.on_wrench(WrenchSample(t, (0.5 + 1e-9 * k, 0.1, -0.2, 0.001, 0.0, 0.0)))

    def kinematics(k: int) -> None:
        t = hear(m, k)
        m.on_joints(JointSample(t, REST))
        m.on_twist(TwistSample(t, TWIST))

    def supervisor(k: int) -> None:
        t = start + k * T
        clock.time_ns = t
        for detector in silence:
            detector.feed(t)
        s.on_pedal(JoySample(t, (1.0,), (0,)))
        s.check(t)

    return {"admittance": admittance, "kinematics": kinematics, "supervisor": supervisor}


SWINGS = (40.0, 20.0, 10.0, 5.0, 3.0, 2.0)
"""Seconds of a swing of +-30 degrees about the remote centre on the plant."""


def figures() -> dict[str, float]:
    """Return what the laws promise, computed anew."""
    low_pass = law_parameters(ROBOT, SETTINGS).low_pass
    lags = {
        f"low-pass lag at {f:g} Hz [deg]": round(float(np.degrees(low_pass.phase_lag(f))), 2) for f in (1, 2, 5, 10)
    }
    return {
        "low-pass delay [ms]": round(low_pass.delay() * 1e3, 2),
        **lags,
        **remote_centre(),
        **{key: value for s in SWINGS for key, value in remote_centre_on_plant(s).items()},
    }


def remote_centre(seconds: float = 20.0) -> dict[str, float]:
    """Swing roll and tilt by +-30 degrees about a point 18 mm behind the tip; exact integration at the host rate."""
    period, q, angle, drift = ROBOT.control_period, np.zeros(5), np.radians(30.0), 0.0
    transform = KINEMATICS.transform_tip_to_base(q)
    centre = transform[:3, 3] + 0.018 * transform[:3, 2]
    travel = []
    for k in range(round(seconds / period)):
        phase = 2 * np.pi * k * period / seconds
        rates = angle * 2 * np.pi / seconds * np.array([np.cos(phase), 2.0 * np.cos(2.0 * phase)])
        transform = KINEMATICS.transform_tip_to_base(q)
        spin = np.array([rates[0], 0.0, 0.0]) + rates[1] * transform[:3, 1]
        twist = np.concatenate([np.cross(spin, transform[:3, 3] - centre), spin])
        q = q + period * rcm_velocity(PARAMETERS, q, twist, centre, NO_HOLD, SETTINGS.motion.rcm_gain, period)[0]
        transform = KINEMATICS.transform_tip_to_base(q)
        x, y, _ = shaft_deviation(transform[:3, :3], transform[:3, 3], centre)
        drift = max(drift, float(np.hypot(x, y)))
        travel.append((q[3], KINEMATICS.tilt_linkage.angle(float(q[4]))))
    roll, tilt = np.degrees(np.abs(travel).max(axis=0))
    return {
        "remote centre: drift [um]": float(f"{drift * 1e6:.2g}"),
        "remote centre: roll [deg]": round(float(roll), 2),
        "remote centre: tilt [deg]": round(float(tilt), 2),
    }


def remote_centre_on_plant(seconds: float) -> dict[str, float]:
    """Swing as in `remote_centre`, on the nominal plant: drives with their lag, gravity, encoders with their counts.

    The deviation is that of the true shaft. In 10 s and less the tilt runs at its velocity limit on the way.
    """
    period, plant = ROBOT.control_period, Plant(ROBOT)
    plant.reset(np.zeros(5), np.zeros(6))
    modes, q, previous = VelocityModes(KINEMATICS, SETTINGS.motion.rcm_gain, SETTINGS.motion.rcm_integral), REST, REST
    modes.set_centre(modes.centre_behind_tip(0.018, q), q)
    centre, deviations = np.array(modes.centre), []

    def swing(t: float) -> np.ndarray:
        phase = 2.0 * np.pi * t / seconds
        return np.radians(30.0) * (1.0 - np.exp(-t * t)) * np.array([np.sin(phase), np.sin(2.0 * phase)])

    for k in range(round(seconds / period)):
        transform = KINEMATICS.transform_tip_to_base(q)
        wanted, t = swing(k * period), k * period
        here = np.array([q[3], KINEMATICS.tilt_linkage.angle(q[4])])
        rates = (swing(t + period) - wanted) / period + 2.0 * (wanted - here)
        spin = np.array([rates[0], 0.0, 0.0]) + rates[1] * transform[:3, 1]
        twist = np.concatenate([np.cross(spin, transform[:3, 3] - centre), spin])
        previous = modes.from_twist(q, tuple(twist.tolist()), previous).velocity
        q = tuple(plant.step(np.array(previous), np.zeros(6)).load_position.tolist())
        transform = KINEMATICS.transform_tip_to_base(plant.true_position)
        x, y, _ = shaft_deviation(transform[:3, :3], transform[:3, 3], centre)
        deviations.append(float(np.hypot(x, y)))
    rms = float(np.sqrt(np.mean(np.square(deviations))))
    return {
        f"remote centre on the plant, {seconds:g} s: largest [um]": round(max(deviations) * 1e6, 2),
        f"remote centre on the plant, {seconds:g} s: rms [um]": round(rms * 1e6, 2),
    }


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--repeat", type=int, default=5000, help="calls per figure")
    options = parser.parse_args()
    costs = {**law_costs(options.repeat), **node_costs(options.repeat)}
    result = {"costs": costs, "figures": figures()}
    if options.json:
        print(json.dumps(result))
        return
    for name, row in costs.items():
        print(f"{name:52s} p50 {row['p50_us']:8.2f} us   p99 {row['p99_us']:8.2f} us")
    for name, value in result["figures"].items():
        print(f"{name:52s} {value:g}")


if __name__ == "__main__":
    main()
