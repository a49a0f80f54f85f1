"""Compile the code of the control loop before it runs: a first call takes seconds, later ones microseconds.

This is done once in the supervising process; the processes of the graph are its forks and inherit the compiled code.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sher3_description import Robot

STAMP = 1_000_000_000_000
PUSH = (1.0, 1.0, 1.0, 0.02, 0.02, 0.02)


def warm_up(robot: Robot, names: Sequence[str]) -> None:
    """Run each node's computations a few times with inputs that move the robot."""
    for name in names:
        if name in _WARM:
            _WARM[name](robot)


def _admittance(robot: Robot) -> None:
    import numpy as np
    from sher3_control.law.admittance import LawInput, initial_state, step
    from sher3_control.law.angles import roll_and_tilt
    from sher3_control.law.live_parameters import live_parameters
    from sher3_control.law.parameters import law_parameters
    from sher3_control.settings import ControlSettings
    from sher3_kinematics.kernel import kernel_parameters

    settings = ControlSettings.from_robot(robot)
    parameters, live, state = law_parameters(robot, settings), live_parameters(settings), initial_state()
    roll, tilt = roll_and_tilt(np.array(kernel_parameters(robot)), 0.01, 0.001)
    period = round(robot.control_period * 1e9)
    for k in range(20):
        stamp, travel = STAMP + k * period, min(0.2 * k, 1.0)
        fx, fy, fz, mx, my, mz = (component * (1.0 + 0.01 * k) for component in PUSH)
        wrench = (fx, fy, fz, mx, my, mz)
        tick = LawInput(
            stamp, True, True, stamp, wrench, stamp, travel, False, stamp, roll, tilt,
            live.speed_scale, live.linear_gain, live.angular_gain, int(live.lock), live.bias,
        )  # fmt: skip
        state, _ = step(state, tick, parameters)


def _kinematics(robot: Robot) -> None:
    import numpy as np
    from sher3_control.motion.controller import MotionController, MotionInput
    from sher3_control.motion.pose import tip_pose_sample, tip_twist_sample
    from sher3_control.settings import ControlSettings
    from sher3_kinematics.kernel import kernel_parameters

    motion = MotionController(robot, ControlSettings.from_robot(robot).motion)
    period, q = round(robot.control_period * 1e9), (0.001, 0.0, -0.001, 0.02, 0.001)
    motion.warm_up()
    motion.cooperative_wants(True, STAMP)
    for k in range(5):
        stamp = STAMP + k * period
        motion.tick(MotionInput(stamp, True, stamp, q, stamp, tuple(1e-3 * component for component in PUSH)))
    tip_pose_sample(np.array(kernel_parameters(robot)), q)
    tip_twist_sample(np.array(kernel_parameters(robot)), q, q)


def _motor_driver(robot: Robot) -> None:
    from sher3_drivers.settings import default_settings
    from sher3_drivers.units import AxisScale
    from sher3_drivers.watches.motion import MotionWatch

    MotionWatch([AxisScale.from_actuator(a) for a in robot.actuators], default_settings(robot.control_period))


def _plant(robot: Robot) -> None:
    from sher3_sim.plant import Plant

    plant = Plant(robot)
    for _ in range(3):
        plant.step([0.001] * 5, PUSH)


_WARM: dict[str, Callable[[Robot], None]] = {
    "admittance": _admittance,
    "kinematics": _kinematics,
    "motor_driver": _motor_driver,
    "plant": _plant,
}


def main() -> None:
    """Fill the cache of compiled code, so that the first start is as fast as the others."""
    from sher3_description import load_robot

    warm_up(load_robot(), tuple(_WARM))


if __name__ == "__main__":
    main()
