"""Bench: what causes are worth on motion that they were not fitted on.

An axis is diagnosed in one motion; its causes then foretell the force of the same axis in another motion of other pace
and size. Beside it stand two fits to the same first record: all columns of the dictionary by least squares, whose
structure is wrong where friction falls with speed or the effort is late, and one that knows the true structure.

    nice python bench/predicts.py                  # 20 drawn axes
    nice python bench/predicts.py --seeds 7:9      # others

An error is the rms of what is left of the force, over that of the force less its nominal part, on the same samples.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from drawn_machines import columns_of, plain_fit
from numpy.typing import NDArray
from sher3_diagnosis import diagnose
from sher3_diagnosis.attribute.candidates import Candidates
from sher3_diagnosis.channel import Channel
from sher3_diagnosis.fit.fitting import Fit, fit
from sher3_diagnosis.fit.term import again
from sher3_diagnosis.quantify.closure import residual_after

sys.path.insert(0, str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
from drawn_axes import Drawn, drawn_axis

HALF, ALIKE = 0.5, 1.1
"""Error over that of the wrong structure, and over that of the true one, that is asked for."""
ROUNDS = 3
"""Rounds over the true causes, each searched beside the others."""
FORCE = Channel("motor_mechanics", "axis")


class Errors(NamedTuple):
    """Errors on the motion held out, as shares of the gap there."""

    causes: float
    wrong: float
    true: float


def predicted(one: Drawn, other: Drawn) -> Errors:
    """Return the errors on one record of what was fitted on another record of the same axis."""
    evidence = balance_of(other)
    view = evidence.records[0]
    judged = np.zeros(view.run.ticks, dtype=bool)
    judged[view.run.grid[view.in_motion]] = True
    nothing = left_by(evidence.null(), evidence)
    parts = left_by(of_causes(one), evidence), of_all(one, other, judged), left_by(of_truth(one), evidence)
    return Errors(*(x / nothing for x in parts))


def of_causes(one: Drawn) -> Fit:
    """Return the fit of the causes that a diagnosis names."""
    findings = diagnose(one.machine, [one.run]).findings
    return next(f.attribution.fit for f in findings if FORCE in f.evidence.channels)


def of_truth(one: Drawn) -> Fit:
    """Return the fit of the true causes, each with its best shape beside the others; the true delay is given."""
    evidence = balance_of(one)
    known = {e.id: e for e in one.machine.of(evidence).effects(evidence)}
    candidates, terms = Candidates(evidence, list(known.values())), {}
    if one.late:
        shape = {"delay": one.late, "of_effort": 1.0, "least": 0.0}
        terms["sensor_delay"] = candidates.term(known["sensor_delay"], "axis", shape)
    names = set(one.truth) - {"sensor_delay"} - ({"gravity_load"} if "spring_torque" in one.truth else set())
    for name in ROUNDS * sorted(names, key=lambda n: (known[n].dry, n)):
        others = [t for n, t in terms.items() if n != name]
        best = candidates.best(known[name], "axis", [*evidence.nuisance, *others])
        terms |= {name: best.terms[-1]} if best else {}
    return fit(evidence.data, [*evidence.nuisance, *terms.values()])


def balance_of(drawn: Drawn) -> Any:
    """Return the evidence in the force balance of a drawn axis."""
    return next(e for e in drawn.machine.gather([drawn.run]) if FORCE in e.channels)


def left_by(found: Fit, evidence: Any) -> float:
    """Return what a fit leaves of the force of other evidence."""
    moved = fit(evidence.data, again(evidence.data, found.terms))
    held = np.broadcast_to(found.coefficients, moved.loro_coefficients.shape)
    return rms(*residual_after(evidence, replace(moved, loro_coefficients=held), FORCE).values())


def of_all(one: Drawn, other: Drawn, judged: NDArray[np.bool_]) -> float:
    """Return what least squares of all columns leaves, on the samples that are judged."""
    x, y = columns_of(other)
    end = (len(judged) - len(y)) // 2  # the filter spoils both ends
    return rms((y - x @ plain_fit(*columns_of(one)))[judged[end : end + len(y)]])


def rms(*parts: NDArray[np.float64]) -> float:
    """Return the root mean square of all parts."""
    return float(np.sqrt(np.mean(np.concatenate([np.ravel(x) for x in parts]) ** 2)))


def table(predict: Callable[[int], Errors], machines: str, seeds: str, words: tuple[str, str]) -> None:
    """Print a line for each machine of the seeds that are asked for, and how many keep both bounds.

    Args:
        predict: errors of the machine of a seed.
        machines: what they are.
        seeds: range of them where none is asked for.
        words: what the causes and the fit of the wrong structure are called.
    """
    parser = argparse.ArgumentParser(description=f"What causes of drawn {machines} foretell of another motion.")
    parser.add_argument("--seeds", default=seeds)
    found, (ours, wrong) = [], words
    for seed in range(*map(int, parser.parse_args().seeds.split(":"))):
        e = predict(seed)
        found.append(e)
        print(f"{seed}: {ours} {e.causes:.4f}  {wrong} {e.wrong:.4f}  true structure {e.true:.4f}", flush=True)
    ratios = np.array([(e.causes / e.wrong, e.causes / e.true) for e in found])
    half, alike = np.median(ratios, axis=0)
    print(f"{len(found)} {machines}; median over {wrong} {half:.2f}, over the true structure {alike:.2f}")
    print(f"at most {HALF} of {wrong}: {np.mean(ratios[:, 0] <= HALF):.2f}", end="; ")
    print(f"at most {ALIKE} of the true structure: {np.mean(ratios[:, 1] <= ALIKE):.2f}")


def of_axis(seed: int) -> Errors:
    """Return the errors of a drawn axis in another motion of its own."""
    return predicted(drawn_axis(seed), drawn_axis(seed, motion=1))


if __name__ == "__main__":
    table(of_axis, "axes", "7500:7520", ("causes", "all columns"))
