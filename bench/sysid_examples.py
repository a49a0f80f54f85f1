"""The examples that come with mujoco.sysid, fitted as published and diagnosed beside: needs the extra `sysid`.

Models, true numbers and how data are made come with the package, in its tests; the cart, whose mass and gear no motion
tells apart, and the noise of 0.6 rad on the arm are those of its notebook. The fit is told which numbers are wrong.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable, Mapping
from contextlib import redirect_stdout
from functools import partial
from io import StringIO
from typing import Any, NamedTuple

import mujoco
import numpy as np
import sher3.gap as gap
from numpy.typing import NDArray

Array = NDArray[np.float64]
CART = """<mujoco><option timestep="0.002"><flag contact="disable"/></option><worldbody><body name="cart">
<inertial pos="0 0 0" mass="2" diaginertia="0.001 0.001 0.001"/><joint name="slide" type="slide" axis="1 0 0"/></body>
</worldbody><actuator><motor name="motor" joint="slide" gear="3"/></actuator>
<sensor><jointpos name="position" joint="slide"/></sensor></mujoco>"""
LOUD, SEED = 0.6, 0
"""Noise of the notebook on positions, rad, and the seed of it there."""
OTHER = 1.3
"""By how much faster the sines of the motion are that neither sees."""


class Number(NamedTuple):
    """A number to fit: true value, where the wrong model has it, bounds, and what sets it in a model and reads it."""

    true: float
    wrong: float
    low: float
    high: float
    put: Callable[[mujoco.MjSpec, float], None]
    read: Callable[[mujoco.MjModel], float]


class Example(NamedTuple):
    """A published example: model, sines of its controls (amplitude, Hz, phase), seconds, noise, and what is wrong."""

    xml: str
    sines: tuple[tuple[tuple[float, float, float], ...], ...]
    seconds: float
    noise: float
    numbers: Mapping[str, Number]


def mass_of(body: str, true: float, wrong: float, low: float, high: float) -> Number:
    """Return the mass of a body, kg."""
    return Number(
        true, wrong, low, high, lambda s, x: setattr(s.body(body), "mass", x), lambda m: float(m.body(body).mass[0])
    )


def rotor_of(joint: str, true: float) -> Number:
    """Return the armature of a joint, kg m^2."""
    read = lambda m: float(m.joint(joint).armature[0])  # noqa: E731
    return Number(true, 0.01, 0.001, 1.0, lambda s, x: setattr(s.joint(joint), "armature", x), read)


def gear_of(drive: str, true: float, wrong: float) -> Number:
    """Return the gear of a motor."""

    def put(spec: mujoco.MjSpec, x: float) -> None:
        spec.actuator(drive).gear[0] = x

    return Number(true, wrong, 0.5, 8.0, put, lambda m: float(m.actuator(drive).gear[0]))


def examples() -> dict[str, Example]:
    """Return the examples by what is wrong in them."""
    from mujoco.sysid.tests.test_integration import ARM_XML, SPRING_MASS_XML, TRUE_ARMATURE

    arm = tuple(
        ((size, pace, phase),)
        for size, pace, phase in ((5, 0.5, 0.0), (4, 0.7, 0.5), (3, 0.4, 1.0), (2, 0.9, 1.5), (1, 0.6, 2.0))
    )
    rotors = {name: rotor_of(name, true) for name, true in TRUE_ARMATURE.items()}
    pair = {"mass": mass_of("cart", 2.0, 3.5, 0.5, 5.0), "gear": gear_of("motor", 3.0, 5.25)}
    spring = {"mass": mass_of("ball", 1.0, 2.0, 0.3, 3.0)}
    pushed = (((3.0, 2.0, 0.0), (2.0, 5.0, 0.0)),)
    return {
        "slide on a spring, twice its mass": Example(
            SPRING_MASS_XML, (((5.0, 1.5, 0.0), (3.0, 3.7, 0.0)),), 3.0, 0.0, spring
        ),
        "arm, five rotors": Example(ARM_XML, arm, 2.0, 0.0, rotors),
        "the same, noise of 0.6 rad": Example(ARM_XML, arm, 10.0, LOUD, rotors),
        "cart, mass and gear": Example(CART, pushed, 0.6, 0.0, pair),
    }


def rolled(model: mujoco.MjModel, example: Example, faster: float = 1.0) -> tuple[Array, Array, Array, Array]:
    """Return stamps and controls, and stamps and readings, of a rollout as the examples make it."""
    from mujoco import rollout, sysid

    stamps = np.arange(int(example.seconds / model.opt.timestep)) * model.opt.timestep
    ctrl = np.column_stack(
        [sum(a * np.sin(2.0 * np.pi * faster * f * stamps + p) for a, f, p in sines) for sines in example.sines]
    )
    data = mujoco.MjData(model)
    start = sysid.create_initial_state(model, data.qpos, data.qvel, data.act)
    state, sensor = rollout.rollout(model, data, start, ctrl[:-1])
    return stamps, ctrl, state[0][:, 0], sensor[0]


def sequences_of(example: Example) -> Any:
    """Return a `ModelSequences` of the measured motion with the model whose numbers are wrong."""
    from mujoco import sysid

    spec = mujoco.MjSpec.from_string(example.xml)
    model = spec.compile()
    stamps, ctrl, times, sensor = rolled(model, example)
    noisy = sensor + example.noise * np.random.default_rng(SEED).standard_normal(sensor.shape)
    for number in example.numbers.values():
        number.put(spec, number.wrong)
    start = sysid.create_initial_state(model, np.zeros(model.nq), np.zeros(model.nv))
    series = (sysid.TimeSeries(stamps, ctrl), sysid.TimeSeries.from_names(times, noisy, model))
    return sysid.ModelSequences("example", spec, "measured", start, *series)


def fitted(sequences: Any, numbers: Mapping[str, Number]) -> mujoco.MjModel:
    """Return the model with the numbers that mujoco.sysid fits."""
    from mujoco import sysid

    params = sysid.ParameterDict()
    for name, x in numbers.items():
        modifier = partial(lambda put, s, p: put(s, float(p.value[0])), x.put)
        params.add(sysid.Parameter(name, nominal=x.true, min_value=x.low, max_value=x.high, modifier=modifier))
        params[name].value[:] = x.wrong
    residual = sysid.build_residual_fn(models_sequences=[sequences])
    found, _ = sysid.optimize(initial_params=params, residual_fn=residual, optimizer="mujoco", verbose=False)
    done = sysid.apply_param_modifiers(found, sequences.spec)
    return done if isinstance(done, mujoco.MjModel) else done.compile()


def diagnosed(sequences: Any) -> gap.Answer:
    """Return the answer of the diagnosis."""
    return gap.from_sysid(sequences)


def lines_of(function: Callable[..., Any]) -> int:
    """Return how many lines a function has but for its head and docstring."""
    return sum(bool(line.strip()) for line in inspect.getsource(function).splitlines()) - 2


def told(answer: gap.Answer) -> str:
    """Return the answer in one sentence, and what the motion does not tell where there is no gap."""
    untold = [note for note in answer.notes if "cannot tell" in note]
    return " ".join([answer.headline, *untold[: answer.status == "no_gap"]])


def row(name: str, example: Example) -> str:
    """Return a row of the table."""
    sequences = sequences_of(example)
    real, wrong = mujoco.MjModel.from_xml_string(example.xml), sequences.spec.compile()
    truth = rolled(real, example, OTHER)[3]

    def missed(model: mujoco.MjModel) -> str:
        own, untuned = (float(np.std(rolled(m, example, OTHER)[3] - truth)) for m in (model, wrong))
        each = [abs(x.read(model) / x.true - 1.0) for x in example.numbers.values()]
        return f"{max(each):.2%} | {own / untuned:.3f}" if untuned > 1e-9 else f"{max(each):.2%} | no gap"

    def timed(act: Callable[[], Any]) -> tuple[Any, float]:
        began = time.perf_counter()
        with redirect_stdout(StringIO()):
            found = act()
        return found, time.perf_counter() - began

    theirs, their_seconds = timed(lambda: fitted(sequences_of(example), example.numbers))
    try:
        answer, seconds = timed(lambda: diagnosed(sequences))
        text = answer.corrected().text if answer.causes else ""
        ours = missed(mujoco.MjModel.from_xml_string(text) if text else wrong)
        said = f"{told(answer)} | {ours} | {seconds:.1f} s"
    except ValueError as error:
        said = f"Refused: {error} | | | "
    return f"| {name} | {missed(theirs)} | {their_seconds:.1f} s | {said} |"


def table() -> None:
    """Print the table of the published examples."""
    print(f"Lines beyond model and data: {lines_of(fitted)} and {lines_of(diagnosed)}.\n")
    print("| wrong in the model | mujoco.sysid: off by | error held out | | here | off by | error held out | |")
    print("|---|---|---|---|---|---|---|---|")
    for name, example in examples().items():
        print(row(name, example), flush=True)


if __name__ == "__main__":
    table()
