"""A gap of a running robot is named within ten seconds of motion, and none of a healthy robot."""

from dataclasses import replace

import numpy as np
import pytest
from sher3_common.samples import JointSample, WrenchSample
from sher3_effects import plants
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.live.monitor import Monitor
from sher3_gap.live.naming import LEAST, Naming, pieces
from sher3_sim import Plant
from simulated import ROBOT, samples

SWEEP = excite("sweep", ROBOT)


def swept(effects, times, seed=0):
    """Return one run of several sweeps, which begin and end at rest at the same place."""
    longer = replace(SWEEP, position=np.tile(SWEEP.position, (times, 1)), velocity=np.tile(SWEEP.velocity, (times, 1)))
    (run,) = rehearse(ROBOT, [(longer, 0)], effects, seed=seed, scatter=None)
    return run


def running(effect, times, at):
    """Yield the samples of a plant that sweeps, in which an effect is switched on at a time, s."""
    plant = Plant(ROBOT, seed=1)
    position, velocity = (np.tile(x, (times, 1)) for x in (SWEEP.position, SWEEP.velocity))
    top = np.array([a.limits.velocity for a in ROBOT.actuators])
    read, period = plant.reset(position[0]), ROBOT.control_period
    for k, (wanted, rate) in enumerate(zip(position, velocity, strict=True)):
        if k == round(at / period):
            effect.apply(plant.parameters)
        stamp = k * round(period * 1e9)
        command = np.clip(rate + ROBOT.position_gain * (wanted - read.load_position), -top, top)
        yield "setpoint_js", JointSample(stamp, tuple(wanted), tuple(rate), None)
        yield "servo_jv", JointSample(stamp, None, tuple(command), None)
        yield "drives/setpoint_jv", JointSample(stamp, None, tuple(read.demand), None)
        motor = (tuple(x) for x in (read.motor_position, read.motor_velocity, read.effort))
        yield "drives/measured_js", JointSample(stamp, *motor)
        yield "measured_js", JointSample(stamp, tuple(read.load_position), None, None)
        yield "force/measured_cf", WrenchSample(stamp, tuple(read.wrench))
        read = plant.step(command)


def watched(effects, times, seed=0):
    """Let a monitor watch several sweeps; return what was named, second by second."""
    return listened(samples(swept(effects, times, seed), ticks=10**7))


def listened(stream):
    """Let a monitor listen to samples; return what was named, second by second."""
    monitor, out, begin = Monitor(ROBOT), [], None
    naming = Naming(ROBOT, monitor.stretch)
    for topic, sample in stream:
        monitor.feed(topic, sample)
        begin = sample.stamp if begin is None else begin
        if topic == "force/measured_cf" and sample.stamp >= begin + (len(out) + 1) * 1_000_000_000:
            found = monitor.judge()
            out.append(naming.look(sample.stamp, any(s.level for s in found)) if found else None)
    return out


@pytest.mark.parametrize(
    "effect", [plants()["coulomb_friction"]("delta_2", force=1.5), plants()["backlash"]("tilt", width=4e-5)]
)
def test_an_effect_is_named_within_ten_seconds_of_motion(effect):
    told = watched([effect], 3)
    second, named = next((k + 1, n) for k, n in enumerate(told) if n is not None)
    assert second <= 10
    assert (effect.id, effect.actuator) in [(c.effect, c.actuator) for c in named.verdict.causes], named.text


@pytest.mark.parametrize(
    "effect", [plants()["coulomb_friction"]("delta_2", force=1.5), plants()["backlash"]("tilt", width=4e-5)]
)
def test_an_effect_that_is_switched_on_in_the_running_plant_is_named_with_its_probability(effect):
    """Six seconds of a healthy robot, then ten of motion with the effect."""
    told = listened(running(effect, 4, at=6.0))
    second, named = next((k + 1, n) for k, n in enumerate(told) if n is not None)
    assert 6 < second <= 16
    causes = {(c.effect, c.actuator): c.probability for c in named.verdict.causes}
    assert causes[effect.id, effect.actuator] > 0.5, named.text
    assert f"{effect.id}:{effect.actuator}" in named.verdict.probabilities


def test_a_healthy_robot_is_not_named():
    told = watched([], 2)
    assert len(told) == 9 and all(n is None for n in told)


def test_a_stretch_is_cut_into_pieces_of_its_own():
    monitor = Monitor(ROBOT)
    for topic, sample in samples(swept([], 1)):
        monitor.feed(topic, sample)
    whole = monitor.stretch(4.0)
    parts = pieces(whole)
    assert sum(p.ticks for p in parts) == whole.ticks and len({p.name for p in parts}) == len(parts)
    assert all(p.stage_clock[0] == 0.0 for p in parts) and monitor.stretch(10.0 * LEAST) is None
