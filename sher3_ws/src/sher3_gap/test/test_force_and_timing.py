"""The force between ticks, and commands that come late tick by tick: what the mechanics' residual rests on."""

import numpy as np
import pytest
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.localise.gaps import gap_of
from sher3_effects import plants
from sher3_gap.evidence import gather
from sher3_gap.stages.exact.timing import demand_in_force, timing_of
from sher3_gap.stages.geometry import Geometry
from sher3_gap.stages.residuals import motor_residual, step_share
from simulated import ROBOT, runs_of, signals


def rms(run, demand=None):
    """Force that the nominal axes do not explain, (5,), over the rated force."""
    found = motor_residual(run, ROBOT, Geometry(ROBOT), demand)
    return np.array([found[Channel("motor_mechanics", a.name)].rms()[0] / a.drive.rated for a in ROBOT.actuators])


def test_a_step_relaxes_to_less_than_half():
    assert step_share(np.array([1e-4]))[0] == pytest.approx(0.5, abs=1e-4)
    u = np.linspace(0.0, 1.0, 20001)
    curve = (np.exp(-0.5 * u) - np.exp(-0.5)) / (1.0 - np.exp(-0.5))
    assert step_share(np.array([0.5]))[0] == pytest.approx(np.mean(curve), abs=1e-4)


def test_the_nominal_mass_is_found_to_a_half_percent():
    run = signals(runs_of(("sweep",), repeats=1))[0]
    for i, actuator in enumerate(ROBOT.actuators):
        residual = motor_residual(run, ROBOT, Geometry(ROBOT))[Channel("motor_mechanics", actuator.name)]
        force = run.to_grid(actuator.mass * run.acceleration[:, i])[residual.ok]
        bias = float(force @ residual.values[residual.ok, 0] / (force @ force))
        assert abs(bias) < 0.008, actuator.name


@pytest.mark.parametrize(
    ("effect", "parameters"), [("dropped_commands", {"probability": 0.05}), ("command_jitter", {"sigma": 3e-4})]
)
def test_late_commands_are_no_force(effect, parameters):
    healthy = signals(runs_of(("steps",), repeats=1))
    late = signals(runs_of(("steps",), [plants()[effect]("all", **parameters)], repeats=1))
    timing = timing_of(late, ROBOT)
    told = rms(late[0], demand_in_force(late[0], ROBOT, timing))
    assert (told < 1.15 * rms(healthy[0])).all()
    if effect == "command_jitter":  # the echo, a mean over the interval, is not what the drive held at its end
        assert rms(late[0]).max() > 1.5 * told.max()


def test_one_axis_alone_tells_its_ticks():
    runs = signals(runs_of(("sweep", "steps"), [plants()["command_jitter"]("delta_1", sigma=3e-4)], repeats=1))
    timing = timing_of(runs, ROBOT)
    assert timing.alone == 0
    assert timing.per_tick < 1e-12 * timing.energy
    assert timing.drops == 0.0


def test_no_force_is_told_without_the_echo():
    run = signals(runs_of(("steps",), repeats=1))[0]
    object.__setattr__(run, "echo", None)
    assert motor_residual(run, ROBOT, Geometry(ROBOT)) == {}


def test_few_repeats_ask_for_a_larger_gap():
    runs = signals(runs_of(("reversals", "sweep"), [plants()["viscous_friction"]("tilt", extra=40.0)], repeats=3))
    few = [r for r in runs if r.repeat < 2]
    assert (gather(runs, ROBOT).repeats, gather(few, ROBOT).repeats) == (4, 2)
    channel = Channel("motor_mechanics", "tilt")
    many, less = (gap_of(gather(r, ROBOT), channel) for r in (runs, few))
    assert less.power / less.ratio**2 < many.power / many.ratio**2
