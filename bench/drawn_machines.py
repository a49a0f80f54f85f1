"""Bench: machines with three to six causes drawn at once: which are named, with which interval, what is wrong.

Axes and servos are those of `sher3_chain/test/drawn_axes.py`: their friction sticks and slips, their integrator is
Heun's; the diagnosis has other laws. Arms are those of `ladder_arms.py`, run by MuJoCo; a follower is one whose log has
no forces, and whose servos may be late or weak as well. Beside it, on the same records, stand two fits of the same
dictionary: all its columns by least squares, and the lasso whose weight is chosen on the last third of the record; of
an arm the first alone. With `--sysid` axes and servos have mujoco.sysid, too, which fits those of these numbers that a
MuJoCo model has (`drawn_sysid.py`).

    nice python bench/drawn_machines.py                                 # 50 axes and 50 servos
    nice python bench/drawn_machines.py --seeds 7:9 --kinds arm         # others
    nice python bench/drawn_machines.py --kept ladder.jsonl             # goes on where it was stopped
    nice python bench/drawn_machines.py --seeds 1000:1004 --sysid       # mujoco.sysid beside them, axes and servos

Printed are recall and precision of the causes, how many 95 % intervals hold the truth, and the share of verdicts with a
wrong cause; then what was missed, apart where a fit that knows the true structure (`true_structure.py`) does not see it
either, what was wrong, and what was impossible, by name.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections import Counter
from collections.abc import Callable, Collection, Mapping
from functools import partial
from pathlib import Path

import numpy as np
from sher3_chain.readings.signals import signals_of
from sher3_common.numbers.shares import wilson
from sher3_diagnosis import diagnose
from sher3_diagnosis.verdict import Verdict
from true_structure import powerless

sys.path.append(str(Path(__file__).parents[1] / "sher3_ws/src/sher3_chain/test"))
sys.path.append(str(Path(__file__).parents[1] / "tests"))
from drawn_axes import Drawn, drawn_axis, drawn_servo
from ladder_arms import row_of_arm
from meaning import meaningless

ALIKE = {
    "presliding_friction": {"coulomb_friction"},
    "stribeck_friction": {"coulomb_friction"},
    "spring_torque": {"gravity_load"},  # it has a constant force of its own
    "command_delay": {"delay"},
    "sensor_delay": {"delay"},
}
"""Effect -> what else is named with it, since its law contains that."""
NOTICED = 0.05
"""Share of the signal from which a column of the two fits is called a cause."""
COLUMNS = ("payload_mass", "viscous_friction", "coulomb_friction", "gravity_load", "spring_torque")
LASSO_WEIGHTS = np.geomspace(1e-3, 0.3, 12)


def truths(drawn: Drawn) -> set[str]:
    """Return what is to be found; a friction that falls with speed has a dry one in it."""
    more = {"coulomb_friction"} if "stribeck_friction" in drawn.truth else set()
    return set(drawn.truth) | more


def named(verdict: Verdict) -> list[set[str]]:
    """Return for each cause the names that it stands for: its own, its rivals', and what its law contains."""
    out = []
    for c in verdict.causes:
        late = {"delay"} if c.effect == "drive_lag" and "delay" in c.parameters else set()
        out.append({c.effect, *c.rivals, *ALIKE.get(c.effect, ()), *late})
    return out


TOLD_AS = {("sensor_delay", "delay"): "effort_delay"}
"""Effect and name of a truth -> the parameter that tells it."""


def covered(drawn: Drawn, verdict: Verdict) -> list[bool]:
    """Return whether each interval of a parameter whose truth is known holds it."""
    out = []
    for c in verdict.causes:
        for name, value in drawn.truth.get(c.effect, {}).items():
            p = c.parameters.get(TOLD_AS.get((c.effect, name), name))
            if p is not None and p.low is not None and p.high is not None:
                out.append(p.low <= value <= p.high)
    return out


def columns_of(drawn: Drawn) -> tuple[np.ndarray, np.ndarray]:
    """Return the dictionary (n, 7) and what it is to explain (n,): the force less the stated mass, or the error."""
    axis = drawn.machine.described.axes[0]
    run = signals_of(drawn.run, axis, "run")
    q, v = run.smooth[:, 0], run.velocity[:, 0]
    a = run.filtered(run.acceleration)[:, 0]
    if axis.servo:
        y = run.filtered(run.reference - run.motor)[:, 0]
    else:
        y = run.filtered(run.effort)[:, 0] - axis.mass * a - axis.gravity.arm * np.sin(q)
    soft = np.tanh(v / (0.02 * np.abs(v).max()))
    x = np.column_stack([a, v, soft, np.ones_like(q), q - q.mean(), np.sin(q), np.cos(q)])
    keep = slice(int(run.edge), -max(1, int(run.edge)))
    x, y = x[keep], y[keep]
    return (x[:, :5], y) if axis.motion == "linear" else (x[:, [0, 1, 2, 3, 5, 6]], y)


def plain_fit(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the coefficients of all columns by least squares."""
    return np.linalg.lstsq(x, y, rcond=None)[0]


def lasso(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the coefficients of the lasso (coordinate descent), its weight chosen on the last third."""
    size, cut = np.sqrt(np.mean(x**2, axis=0)), len(y) * 2 // 3
    z = x / size
    errors = [float(np.mean((y[cut:] - z[cut:] @ _descend(z[:cut], y[:cut], w)) ** 2)) for w in LASSO_WEIGHTS]
    return np.asarray(_descend(z, y, LASSO_WEIGHTS[int(np.argmin(errors))]) / size)


def _descend(z: np.ndarray, y: np.ndarray, weight: float) -> np.ndarray:
    gram, right = z.T @ z / len(y), z.T @ y / len(y)
    threshold, beta = weight * float(np.sqrt(np.mean(y**2))), np.zeros(z.shape[1])
    for _ in range(300):
        for k in range(len(beta)):
            free = right[k] - gram[k] @ beta + gram[k, k] * beta[k]
            beta[k] = np.sign(free) * max(abs(free) - threshold, 0.0) / gram[k, k]
    return beta


def by_fit(drawn: Drawn, how: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> set[str]:
    """Return the causes that a fit of columns and signal names: whose column is a noticed share of the signal."""
    x, y = columns_of(drawn)
    beta = how(x, y)
    names = [*COLUMNS] if x.shape[1] == 5 else [*COLUMNS[:4], "gravity_load", "gravity_load"]
    if drawn.kind == "servo":
        names = ["drive_lag" if n in ("payload_mass", "viscous_friction") else n for n in names]
    shares = np.abs(beta) * np.sqrt(np.mean(x**2, axis=0)) / np.sqrt(np.mean(y**2))
    return {n for n, s in zip(names, shares, strict=True) if s > NOTICED}


WIDTHS = ("width", "displacement", "reach", "amplitude")
"""Parameters of a lost motion or a friction that no travel is smaller than."""


def impossible(drawn: Drawn, verdict: Verdict) -> list[str]:
    """Return what no verdict may say: a number that may be zero, or misses its interval, a width beyond the travel."""
    travel = float(np.ptp(drawn.run.signals["axis"]["position"]))
    told = ((c.effect, n, p) for c in verdict.causes for n, p in c.parameters.items() if n in WIDTHS)
    wide = [f"{e} {n} {p.value:.3g} of a travel of {travel:.3g}" for e, n, p in told if p.value > travel]
    return [*meaningless(verdict), *wide]


def by_sysid(drawn: Drawn) -> set[str]:
    """Return what mujoco.sysid names, by the same share of the signal."""
    from drawn_sysid import fitted

    return by_fit(drawn, lambda x, y: fitted(drawn))


def row_of_axis(draw, fits: Mapping[str, Callable[[Drawn], set[str]]], seed: int) -> dict:
    """Return what is kept of one axis or servo."""
    drawn = draw(seed)
    begun = time.perf_counter()
    verdict = diagnose(drawn.machine, [drawn.run]).verdict
    return {
        "seconds": time.perf_counter() - begun,
        "status": verdict.status,
        "truth": sorted(truths(drawn)),
        "powerless": sorted(powerless(drawn)),
        "held": covered(drawn, verdict),
        "impossible": impossible(drawn, verdict),
        "sher3": [sorted(x) for x in named(verdict)],
        **{name: [[x] for x in sorted(named_by(drawn))] for name, named_by in fits.items()},
    }


FITS = {"least squares": partial(by_fit, how=plain_fit), "lasso": partial(by_fit, how=lasso)}
SYSID = "mujoco.sysid"


def drawers(sysid: bool) -> dict[str, Callable[[int], dict]]:
    """Return kind of machine -> what draws one from a seed, diagnoses it and returns what is kept of it."""
    fits = FITS | ({SYSID: by_sysid} if sysid else {})
    axes = {"axis": drawn_axis, "servo": drawn_servo}
    arms = {"arm": row_of_arm, "follower": partial(row_of_arm, forces=False)}
    return {**{kind: partial(row_of_axis, draw, fits) for kind, draw in axes.items()}, **arms}


class Score:
    """Counts over machines."""

    def __init__(self) -> None:
        self.right = self.true = self.good = self.all = self.machines = self.spoilt = 0
        self.drawn: Counter[str] = Counter()
        self.missed: Counter[str] = Counter()
        self.blind: Counter[str] = Counter()
        self.wrong: Counter[str] = Counter()

    def add(self, truth: set[str], found: list[set[str]], unseen: Collection[str] = ()) -> None:
        """Count one machine: what is true, the names that each of its causes stands for, what its record lacks."""
        seen = set().union(*found) if found else set()
        bad = [f for f in found if not f & truth]
        self.right, self.true = self.right + len(truth & seen), self.true + len(truth)
        self.good, self.all = self.good + len(found) - len(bad), self.all + len(found)
        self.machines, self.spoilt = self.machines + 1, self.spoilt + bool(bad)
        self.drawn.update(truth)
        self.missed.update(truth - seen - set(unseen))
        self.blind.update((truth - seen) & set(unseen))
        self.wrong.update(sorted(f)[0] for f in bad)

    def line(self) -> str:
        """Return recall, of all and of what has power, precision and the share of machines with a wrong cause."""
        blind = sum(self.blind.values())
        parts = (self.right, self.true), (self.right, self.true - blind), (self.good, self.all)
        words = "recall {}  of what has power {}  precision {}  machines with a wrong cause {}"
        return words.format(*(share(k, n) for k, n in (*parts, (self.spoilt, self.machines))))


def share(count: int, of: int) -> str:
    """Return a share of a number of cases with its 95 % Wilson interval."""
    if not of:
        return "of 0"
    low, high = wilson(count / of, of)
    return f"{count / of:.3f} ({low:.3f} .. {high:.3f}) of {of}"


def rows_of(kind: str, seeds: range, kept: Path | None, sysid: bool = False) -> list[dict]:
    """Return a row for each seed; those in the file are taken from there, others are added to it."""
    known: Mapping[int, dict] = {}
    if kept is not None and kept.exists():
        lines = map(json.loads, kept.read_text(encoding="utf-8").splitlines())
        known = {row["seed"]: row for row in lines if row["kind"] == kind}
    out = []
    for seed in seeds:
        row = known.get(seed) or {"kind": kind, "seed": seed, **drawers(sysid)[kind](seed)}
        out.append(row)
        if kept is not None and seed not in known:
            with kept.open("a", encoding="utf-8") as file:
                file.write(json.dumps(row) + "\n")
    return out


def score_of(rows: list[dict], name: str) -> Score:
    """Return the counts of one way to tell the causes."""
    score = Score()
    for row in rows:
        score.add(set(row["truth"]), [set(x) for x in row[name]], row["powerless"])
    return score


def told(kind: str, rows: list[dict]) -> str:
    """Return the page of one kind of machine."""
    scores = {name: score_of(rows, name) for name in ("sher3", *FITS, SYSID) if name in rows[0]}
    held = [x for row in rows for x in row["held"]]
    odd = [f"{row['seed']}: {x}" for row in rows for x in row["impossible"]]
    ours = scores["sher3"]
    lost = ours.missed + ours.blind
    seconds, status = sum(row["seconds"] for row in rows), dict(Counter(row["status"] for row in rows))
    lines = [
        f"{kind}: {len(rows)} machines, {seconds:.0f} s, {status}",
        f"  intervals that hold the truth: {share(sum(held), len(held))}",
        f"  impossible or meaningless: {len(odd)} {odd}",
        "  told: " + ", ".join(f"{x} {n - lost[x]} of {n}" for x, n in sorted(ours.drawn.items())),
    ]
    for name, score in scores.items():
        lines.append(f"  {name:14} {score.line()}")
        missed = f"missed {dict(score.missed)}, for lack of power {dict(score.blind)}"
        lines.append(f"  {'':14} {missed}, wrong {dict(score.wrong)}")
    return "\n".join(lines)


def main() -> None:
    """Print the ladder; nothing impossible may be in it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", default="1000:1050")
    parser.add_argument("--kinds", default="axis,servo")
    parser.add_argument("--kept", type=Path, help="file of results, from which the bench goes on")
    parser.add_argument("--sysid", action="store_true", help="fit axes and servos with mujoco.sysid, too")
    arguments = parser.parse_args()
    seeds = range(*map(int, arguments.seeds.split(":")))
    found = {kind: rows_of(kind, seeds, arguments.kept, arguments.sysid) for kind in arguments.kinds.split(",")}
    for kind, rows in found.items():
        print(told(kind, rows), flush=True)
    sys.exit(any(row["impossible"] for rows in found.values() for row in rows))


if __name__ == "__main__":
    main()
