"""Bench: whether the odds hold on machines that are not SHER, and what labelled cases of such machines make of them.

Chains are drawn axes and servos (`sher3_chain/test/drawn_axes.py`: Karnopp's friction, Heun's steps), such axes
with a force that the library lacks, and arms of MuJoCo (`sher3_arms`); tables are serial arms seen from outside, force
sensors under known weights, and positioning tests (`sher3_static/test`). Every case is judged with the whole library
and without one of its effects.

    nice python bench/other_odds.py chain table --cases 10 30 --kept evidence      # a minute of a core
    nice python bench/other_odds.py chain table --cases 10 30 --kept evidence --beside robots --diagram reliability.png

Printed for each source: log loss and calibration error of the odds by the weights of SHER, as if each cause of a gap
stood alone and as they are judged, and by weights that the other sources moved; then the table, and what is certified
of each source, by the weights of SHER.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import cycle
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from sher3_challenge.calibration.fit import updated
from sher3_challenge.calibration.held_out import Judgement, by_plant, groups, held_out, judged_by
from sher3_challenge.calibration.observe import Observation, keep, observed_on, stored, without_evidence
from sher3_challenge.calibration.selective import curve
from sher3_challenge.calibration.table import SURE, rates, written
from sher3_challenge.score.reliability import calibration_error, diagram
from sher3_common import Sher3Error
from sher3_diagnosis.judge.calibration.calibration import in_force
from sher3_diagnosis.machine import Machine

SOURCES = Path(__file__).parents[1] / "sher3_ws/src"
sys.path[:0] = [
    str(SOURCES / x)
    for x in (
        "sher3_chain/test",
        "sher3_static/test",
        "sher3_static/test/positioning",
        "sher3_static/test/arm",
        "sher3_static/test/sensor",
    )
]
LEAST = 1e-3
"""Probability below which a surprise counts no more."""
FIRST = 20_000
"""First seed; tests and other benches use lower ones."""
ARM_SECONDS = 20.0
FOREIGN = 3
"""Remainder of a table's seed by five at which an error is drawn that no effect of the library gives."""


class Case(NamedTuple):
    """A labelled case: machine, runs, label, and the effects that are left out in turn."""

    machine: Machine
    runs: Sequence[Any]
    truth: dict[str, Any]
    left_out: Sequence[tuple[str, ...]]


def label(
    machine: Machine, effects: Sequence[tuple[str, str]], outside: bool = False, company: Sequence[str] = ()
) -> dict[str, Any]:
    """Return a label as the challenge writes it, of effects and their places."""
    rows, pages = [], {e.id: e for e in machine.library()}
    for name, place in effects:
        page = pages.get(name)
        family, stage = ("outside", "motor_mechanics") if page is None else (page.family, page.stage)
        rows.append({"effect": name, "family": family, "stage": stage, "also": [], "actuator": place})
    for row in rows[:1]:
        row["company"] = list(company)
    status = "outside_library" if outside else "attributed" if rows else "no_gap"
    return {"status": status, "effects": rows, "rivals": []}


def one_of(rng: np.random.Generator, names: Sequence[str]) -> list[tuple[str, ...]]:
    """Return one of several effects to be left out; none where there is none."""
    return [(str(rng.choice(sorted(names))),)] if names else []


def axis(seed: int) -> Case:
    """Return a drawn axis, or a servo at odd seeds."""
    from drawn_axes import drawn_axis, drawn_servo

    drawn = (drawn_servo if seed % 2 else drawn_axis)(seed)
    effects = sorted("command_delay" if name == "delay" else name for name in drawn.truth)
    dry = ["coulomb_friction"] if "stribeck_friction" in effects else []
    truth = label(drawn.machine, [(name, "axis") for name in effects], company=dry)
    return Case(drawn.machine, [drawn.run], truth, one_of(np.random.default_rng(seed), effects))


def foreign_axis(seed: int) -> Case:
    """Return a drawn axis on which a force acts beside its causes that no effect of the library gives.

    The force is added to what the drive gives: the same motion needs that much more.
    """
    from drawn_axes import drawn_axis

    drawn, rng = drawn_axis(seed), np.random.default_rng([seed, 3])
    signals = drawn.run.signals["axis"]
    place, effort = signals["position"], signals["effort"]
    speed = np.gradient(place) / float(np.abs(np.gradient(place)).max())
    place = place / float(np.abs(place).max())
    time = drawn.run.period * np.arange(len(place))
    laws = [
        np.sin(rng.uniform(0.5, 3.0) * time + 1.0),  # of the clock
        speed * place,  # drag that turns with the place
        place**2 - speed**2,
        np.sin(9.0 * place) * np.abs(speed),  # a wave that only acts in motion
    ]
    force = laws[seed % len(laws)]
    size = rng.uniform(0.3, 1.0) * float(np.std(effort)) / float(np.std(force))
    run = replace(drawn.run, signals={"axis": {**signals, "effort": effort + size * force}})
    known = [(name, "axis") for name in sorted(drawn.truth)]
    dry = ["coulomb_friction"] if "stribeck_friction" in drawn.truth else []
    truth = label(drawn.machine, [*known, ("outside_library", "axis")], outside=True, company=dry)
    return Case(drawn.machine, [run], truth, [])


def magnet(seed: int) -> Case:
    """Return a mass that a magnet holds, as in `test_foreign_law.py`: a gain and a payload imitate its law to 98 %."""
    from sher3_chain.joint.record import AxesRun
    from slides import columns
    from slides import machine as slide

    rng, time = np.random.default_rng([31, seed]), np.arange(0.0, 15.0, 0.005)
    waves = [(rng.uniform(0.5e-3, 3e-3), rng.uniform(1.0, 14.0), rng.uniform(0.0, 6.0)) for _ in range(2)]
    gap = 0.010 + sum(size * np.sin(w * time + phase) for size, w, phase in waves)
    bend = sum(-size * w * w * np.sin(w * time + phase) for size, w, phase in waves)
    current = gap * np.sqrt(0.3 * np.maximum(9.81 - bend, 0.1) / 2.1e-4) + rng.normal(0.0, 2e-3, len(time))
    signals = {**columns("position"), **columns("effort", unit="N")}
    machine = slide(signals=signals, mass=0.3, gravity={"constant": -2.943}, encoder_resolution=5e-7)
    read = {"position": gap + rng.normal(0.0, 5e-7, len(time)), "effort": -1.4 * current}
    truth = label(machine, [("outside_library", "slide")], outside=True)
    return Case(machine, [AxesRun("run", 0.005, {"slide": read})], truth, [])


def mujoco_arm(seed: int) -> Case:
    """Return an arm of MuJoCo with the faults that `sher3 gap arms` deals."""
    from sher3_arms.files import CASE, DESCRIPTION, RECORD
    from sher3_arms.score import NAMES
    from sher3_arms.truth.cases import seal
    from sher3_arms.truth.faults import HEALTHY
    from sher3_machines import import_case, open_case

    folder = Path(tempfile.mkdtemp()) / "case"
    told = seal(seed, ["own"], folder, ARM_SECONDS)
    import_case([folder / RECORD], folder / DESCRIPTION, folder / CASE)
    machine, runs = open_case(folder / CASE)
    if told.fault.kind == HEALTHY:
        return Case(machine, runs, label(machine, []), [])
    parts = [(NAMES.get(f.kind), j) for f, j in zip(told.fault.parts, (told.joint, told.second), strict=False)]
    if any(names is None for names, _ in parts):
        return Case(machine, runs, label(machine, [("outside_library", told.joint)], outside=True), [])
    known = [(names[0], told.link if names[0] == "payload_mass" else j) for names, j in parts if names]
    others = [name for names, _ in parts if names for name in names[1:]]
    without = (*dict.fromkeys([known[0][0], *others]),)
    return Case(machine, runs, label(machine, known, company=others), [without])


def seen_arm(seed: int) -> Case:
    """Return a serial arm seen by positions in two runs: two joint zeros off, a base that sinks, or nothing wrong."""
    import test_sights

    rng, off, wrong = np.random.default_rng(seed), np.zeros(6), seed % 5
    joints = rng.choice(np.arange(1, 5), 2, replace=False)
    off[joints] = rng.uniform(4e-3, 12e-3, 2) * rng.choice([-1.0, 1.0], 2) * (wrong < FOREIGN)
    described = test_sights.arm("positions")
    data = [test_sights.seen("positions", off, zero, 150, seed + k) for k, zero in enumerate((0.0, 2e-3))]
    for x in data:
        x["p"][:, 2] -= (wrong == FOREIGN) * rng.uniform(0.002, 0.01) * np.sin(4.0 * x["p"][:, 0])
    runs = [test_sights.KIND.read(f"run {i}", x, described) for i, x in enumerate(data)]
    return of_table(test_sights.KIND.machine(described), runs, "encoder_offset", np.flatnonzero(off), wrong)


def of_table(machine: Machine, runs: Sequence[Any], effect: str, joints: Sequence[int], wrong: int) -> Case:
    """Return the case of an arm with one effect on several joints."""
    if wrong == FOREIGN:
        return Case(machine, runs, label(machine, [("outside_library", "tip")], outside=True), [])
    places = [(effect, f"j{j + 1}") for j in joints]
    return Case(machine, runs, label(machine, places), [(effect,)] if places else [])


def sensor(seed: int) -> Case:
    """Return a force sensor under weights with a bias, a gain, a crosstalk, two of them, a bend or none."""
    import test_weights as w

    rng, matrix, bias = np.random.default_rng(seed), np.eye(6), np.zeros(6)
    wrong = [
        ("force_bias",), ("force_scale",), ("force_crosstalk",), ("outside_library",), (),
        ("force_bias", "force_scale"),
    ][seed % 6]  # fmt: skip
    if "force_bias" in wrong:
        bias = np.r_[rng.uniform(-3.0, 3.0, 3), rng.uniform(-0.1, 0.1, 3)]
    if "force_scale" in wrong:
        matrix[2, 2] += rng.uniform(0.02, 0.08)
    if "force_crosstalk" in wrong:
        matrix[0, 1] = rng.uniform(0.01, 0.06)
    data, foreign = w.weighed(bias, matrix, seed=seed), "outside_library" in wrong
    axis = int(rng.integers(3))
    data["f"][:, axis] += foreign * rng.uniform(0.003, 0.02) * data["f"][:, axis] ** 2 / 10.0
    machine, places = w.KIND.machine(w.APPLIED), [(name, "force_sensor") for name in wrong]
    runs = [w.KIND.read("run", data, w.APPLIED)]
    return Case(machine, runs, label(machine, places, outside=foreign), [] if foreign else one_of(rng, wrong))


def positioning(seed: int) -> Case:
    """Return a positioning test with one or two errors, with a knock in the middle, or with none."""
    import test_positioning as p

    rng, wrong = np.random.default_rng(seed), seed % 5
    sizes = {"scale": 20e-6, "reversal": 6e-6, "growth": 8e-6, "drift": 5e-6, "bump": 5e-6}
    names = {
        "scale": "lead_error", "reversal": "backlash", "growth": "thermal_expansion", "drift": "position_drift",
        "bump": "position_error_map",
    }  # fmt: skip
    chosen = list(rng.choice(sorted(sizes), 1 + wrong % 2, replace=False)) if wrong < FOREIGN else []
    errors = {x: float(rng.uniform(0.5, 2.0) * rng.choice([-1.0, 1.0])) * sizes[x] for x in chosen}
    data, described = p.table(**errors, seed=seed), p.description()
    knocked = (wrong == FOREIGN) * rng.uniform(3e-6, 10e-6)
    data["reading"][int(rng.uniform(0.3, 0.7) * len(data["reading"])) :] += knocked
    machine, runs = p.KIND.machine(described), [p.read_tests("a", data, described)]
    known = [names[x] for x in chosen]
    if wrong == FOREIGN:
        return Case(machine, runs, label(machine, [("outside_library", "x")], outside=True), [])
    return Case(machine, runs, label(machine, [(n, "x") for n in known]), one_of(rng, known))


KINDS = {
    "chain": {
        "drawn axes": axis,
        "axes with a foreign force": foreign_axis,
        "magnets": magnet,
        "arms of MuJoCo": mujoco_arm,
    },
    "table": {"arms from outside": seen_arm, "force sensors": sensor, "positioning": positioning},
}


def seen(kind: str, seeds: range, kept: Path) -> Iterator[Observation]:
    """Yield the observations of a kind of machines; those in `kept` are not computed again."""
    for source, draw in KINDS[kind].items():
        for seed in seeds:
            file = kept / source.replace(" ", "_") / f"{seed}.json"
            found = stored(file)
            if not found:
                try:
                    case = draw(seed)
                    found = observed_on(
                        case.machine, source, str(seed), case.truth, case.runs, [(), *map(tuple, case.left_out)]
                    )
                except Sher3Error as error:
                    print(f"{source} {seed}: left out: {error}", file=sys.stderr)
                    continue
                keep(found, file)
            yield from found


def surprise(stated: Sequence[tuple[float, bool]]) -> str:
    """Return log loss and calibration error of odds of causes beside whether each is right, and how many there are."""
    if not stated:
        return "no causes"
    loss = -np.mean([math.log(max(p if right else 1.0 - p, LEAST)) for p, right in stated])
    sure = [right for p, right in stated if p >= SURE]
    return (
        f"log loss {loss:.2f}, calibration error {calibration_error(stated):.2f} (n {len(stated)}), "
        f"stated 95 % and more right in {sum(sure)} of {len(sure)}"
    )


def causes_of(judged: Sequence[Judgement]) -> list[tuple[float, bool]]:
    """Return the odds of all causes, and whether the library has them."""
    return [c for j in judged for c in j.causes]


def shown(kind: str, found: Sequence[Observation]) -> None:
    """Print how the odds hold on every source of a kind, and the table of each left out."""
    robot, own = in_force(), groups(found, by_plant)
    left_out = held_out(found, by_plant, partial(updated, robot))
    for source, rows in own.items():
        alone = [without_evidence(row, "part") for row in rows]
        print(f"{source}: weights of SHER, each cause alone: {surprise(causes_of(judged_by(robot, alone)))}")
        print(f"{source}: weights of SHER: {surprise(causes_of(judged_by(robot, rows)))}")
        print(f"{source}: moved by the other sources: {surprise(causes_of(left_out[source]))}")
    print(f"\n{kind}: status by odds, weights of SHER")
    print(written({name: rates(judged_by(robot, rows)) for name, rows in own.items()}))
    for source, rows in own.items():
        print(f"\n{source}\n" + curve(causes_of(judged_by(robot, rows))))


def main() -> None:
    """Print how the odds hold on every source, and draw them beside those of SHER."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kinds", nargs="+", choices=KINDS)
    parser.add_argument("--cases", type=int, nargs="+", default=[10], help="of each source; one number for each kind")
    parser.add_argument("--first", type=int, default=FIRST, help="seed")
    parser.add_argument("--kept", type=Path, default=None, help="folder that keeps the evidence")
    parser.add_argument("--beside", type=Path, default=None, help="evidence of SHER, whose plants are drawn beside")
    parser.add_argument(
        "--diagram", type=Path, default=None, help="picture: one panel a source, by the weights in force"
    )
    options = parser.parse_args()
    kept, every = options.kept or Path(tempfile.mkdtemp()), []
    for kind, cases in zip(options.kinds, cycle(options.cases), strict=False):
        found = list(seen(kind, range(options.first, options.first + cases), kept))
        shown(kind, found)
        every += found
    if options.diagram is not None:
        beside = [] if options.beside is None else sorted(options.beside.rglob("*.json"))
        every = [o for file in beside for o in stored(file)] + every
        judged = {name: judged_by(in_force(), rows) for name, rows in groups(every, by_plant).items()}
        diagram({name: [r for x in j for r in x.right] for name, j in judged.items()}, options.diagram)


if __name__ == "__main__":
    main()
