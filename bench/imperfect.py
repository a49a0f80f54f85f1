"""Bench: what odds make of machines that differ from their pages: axes, arms in motion, arms seen from outside.

Every machine has a level of its own, the share of power by which what it does beyond its nominal is another than its
pages say, drawn log-uniform from 0.3 to 30 %: bent from place to place, drifting slowly, with ripples along the travel.
Sources: three drawn axes or servos a machine, of which every third machine has a foreign force on one; arms of MuJoCo;
arms seen from outside. Each is judged with the whole library and without one of its effects.

    nice python bench/imperfect.py draw EVIDENCE --cases 20 16 20 --first 30000      # seconds of a case
    python bench/imperfect.py real EVIDENCE                                    # the measured sets of SHER3_SHARED
    python bench/imperfect.py table EVIDENCE > docs/reference/odds-imperfect.md
"""

from __future__ import annotations

import argparse
import json
import math
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import measured
import numpy as np
import other_odds as plain
from scipy.signal import savgol_filter
from sher3_challenge.calibration.held_out import item_of as plain_item
from sher3_challenge.calibration.held_out import reproduced as reproduced_plain
from sher3_challenge.calibration.labels import answer_of
from sher3_challenge.calibration.observe import Observation, observed_findings
from sher3_common import Sher3Error
from sher3_common.numbers.shares import wilson
from sher3_diagnosis import diagnose
from sher3_diagnosis.finding import LIBRARY, OUTSIDE, Item
from sher3_diagnosis.judge.calibration.calibration import FILE, in_force
from sher3_diagnosis.judge.costs import DEFAULT
from sher3_diagnosis.judge.evidence.scales import share_of_whole
from sher3_diagnosis.judge.probabilities import judged_together
from sher3_diagnosis.judge.status import answer_to, status_of
from sher3_diagnosis.machine import Machine
from sher3_diagnosis.verdict import Interval

SHARE = (0.003, 0.30)
"""Range of the level."""
AXES = 3
"""Axes of a machine."""
SMOOTH = 41
"""Samples over which a drawn motion is smoothed for its acceleration."""
NAMED = ("attributed", "under_excited")
"""Statuses that name causes."""
HEAD = """# Odds on imperfect machines

How the odds hold on machines that differ from their pages by 0.3 to 30 % of what they do beyond their nominal: bent
from place to place, drifting and rippled ([its level](../explanation/bent-laws.md#the-level-of-a-machine)).
The cases set no weight. A test compares the weights of this page with those in force.

`python bench/imperfect.py draw EVIDENCE --cases 16 16 20 --first 50000` draws them in minutes, `real EVIDENCE` adds the
measured sets where there are some, and `table EVIDENCE` prints this page.

An axis is one of three of its machine. Every share has its 95 % interval; *withheld* is an effect of the library that
was left out, where it leaves what is foreign. Odds are those of causes, at the level of SHER's labelled robots and at
each machine's own."""
SPREAD = "What places with right causes leave over the level of their machine, in logarithms:"
MEASURED = "Of measured sets the causes that are known from outside, and how many of them are named:"


def level(seed: int) -> float:
    """Return the level of the machine of a seed."""
    return float(np.exp(np.random.default_rng([27, seed]).uniform(*np.log(SHARE))))


def imperfection(force: np.ndarray, place: np.ndarray, share: float, rng: np.random.Generator) -> np.ndarray:
    """Return what an imperfect machine adds to a force (n,) at places (n,): a bend, a drift, a ripple of its power."""
    place = (place - place.mean()) / max(float(np.ptp(place)), 1e-12)
    time = np.linspace(0.0, 1.0, len(place))
    turn = 2 * math.pi
    phase = rng.uniform(0.0, turn, 3)
    shapes = (
        force * np.sin(turn * rng.uniform(0.5, 2.0) * place + phase[0]),
        np.sin(turn * rng.uniform(0.3, 1.5) * time + phase[1]),
        np.sin(turn * rng.uniform(4.0, 15.0) * place + phase[2]),
    )
    power = share * float(np.mean(force**2)) * rng.dirichlet(np.ones(3))
    return np.sum([x * math.sqrt(p / max(float(np.mean(x**2)), 1e-300)) for x, p in zip(shapes, power, strict=True)], 0)


def beyond(machine: Machine, signals: dict[str, np.ndarray], period: float) -> tuple[str, np.ndarray]:
    """Return the signal that tells of a drawn axis's force, and what it does beyond the nominal, (n,)."""
    place = signals["position"]
    if "reference" in signals:
        return "reference", signals["reference"] - place
    (axis,) = machine.described.axes
    smooth = savgol_filter(place, min(SMOOTH, len(place) // 4 * 2 - 1), 3, deriv=2, delta=period)
    weight = axis.gravity.arm * np.sin(place)
    return "effort", savgol_filter(signals["effort"] - axis.mass * smooth - weight, 9, 2)


def axis(seed: int) -> plain.Case:
    """Return an axis of the imperfect machine `seed // AXES`; every third has a foreign force on one axis."""
    number, own = divmod(seed, AXES)
    made = plain.foreign_axis(seed) if not number % 3 and own == number // 3 % AXES else plain.axis(seed)
    (run,) = made.runs
    signals = run.signals["axis"]
    name, force = beyond(made.machine, signals, run.period)
    more = imperfection(force, signals["position"], level(number), np.random.default_rng([28, seed]))
    runs = [replace(run, signals={"axis": {**signals, name: signals[name] + more}})]
    names = sorted({e["effect"] for e in made.truth["effects"]} - {"outside_library"})
    return plain.Case(made.machine, runs, made.truth, [(names[0],)] if own == number % AXES else [])


def moving_arm(seed: int) -> plain.Case:
    """Return an arm of MuJoCo of which the faulty joints are imperfect."""
    from sher3_arms.truth.robots import urdf_of
    from sher3_arms.truth.world import inverse, load

    made, rng, urdf = plain.mujoco_arm(seed), np.random.default_rng([29, seed]), load(urdf_of("own"))
    (run,) = made.runs
    joints = list(run.signals)
    q = np.column_stack([run.signals[j]["position"] for j in joints])
    v, a = (savgol_filter(q, SMOOTH, 4, deriv=k, delta=run.period, axis=0) for k in (1, 2))
    over = np.column_stack([run.signals[j]["effort"] for j in joints]) - inverse(urdf, q, v, a)
    places = [e["actuator"] for e in made.truth["effects"]]
    wrong = {x if x in joints else joints[-1] for x in places}  # a payload sits on a link
    signals = dict(run.signals)
    for j in sorted(wrong):
        force = savgol_filter(over[:, joints.index(j)], 9, 2)
        more = imperfection(force, signals[j]["position"], level(seed), rng)
        signals[j] = {**signals[j], "effort": signals[j]["effort"] + more}
    return plain.Case(made.machine, [replace(run, signals=signals)], made.truth, made.left_out)


def seen_arm(seed: int) -> plain.Case:
    """Return an arm seen from outside whose links give way, and whose joints are not round, by its level."""
    import test_sights as sights

    rng, off, wrong = np.random.default_rng(seed), np.zeros(6), seed % 5
    joints = rng.choice(np.arange(1, 5), 2, replace=False)
    off[joints] = rng.uniform(4e-3, 12e-3, 2) * rng.choice([-1.0, 1.0], 2) * (wrong < plain.FOREIGN)
    described, runs = sights.arm("positions"), []
    rates = rng.normal(size=(6, 3)) * 1.5
    sunk = (wrong == plain.FOREIGN) * rng.uniform(0.002, 0.01)
    for k, zero in enumerate((0.0, 2e-3)):
        data = sights.seen("positions", off, zero, 150, seed + k)
        ideal = sights.seen("positions", np.zeros(6), zero, 150, seed + k)
        data["p"][:, 2] -= sunk * np.sin(4.0 * data["p"][:, 0])
        size = math.sqrt(2.0 * level(seed) * float(np.mean((data["p"] - ideal["p"]) ** 2)))
        data["p"] = data["p"] + (wrong <= plain.FOREIGN) * size * np.sin(data["x"] @ rates)
        runs.append(sights.KIND.read(f"run {k}", data, described))
    return plain.of_table(sights.KIND.machine(described), runs, "encoder_offset", np.flatnonzero(off), wrong)


SOURCES = {"axes": axis, "arms of MuJoCo": moving_arm, "arms from outside": seen_arm}


@dataclass(frozen=True)
class Seen:
    """What the engine says of one machine or of one of its axes.

    Attributes:
        source: of the case; `machine`: which one; `share`: its level, 0 where it is not known.
        seen: the evidence.
    """

    source: str
    machine: str
    share: float
    seen: Observation


def seen_of(source: str, number: str, share: float, case: plain.Case, without: Sequence[str]) -> Seen:
    """Diagnose a case without some effects."""
    found = diagnose(case.machine, case.runs, without=without)
    wholes = [f.with_all for f in found.findings]
    return Seen(
        source, number, share, observed_findings(case.machine, wholes, found.exact, source, number, case.truth, without)
    )


def write(file: Path, rows: Sequence[Seen]) -> None:
    """Keep what was seen of a case."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps([asdict(r) for r in rows]), encoding="utf-8")


def read(folder: Path) -> Iterator[Seen]:
    """Yield what was kept."""
    for file in sorted(folder.rglob("*.json")):
        for row in json.loads(file.read_text(encoding="utf-8")):
            listed = {name: tuple(row["seen"][name]) for name in ("without", "items", "exact", "places")}
            yield Seen(**{**row, "seen": Observation(**{**row["seen"], **listed})})


class Judgement(NamedTuple):
    """A row with its status and the odds of its causes: probability, and whether the library is right; None untold."""

    row: Seen
    status: str
    named: list[tuple[str, str]]
    causes: list[tuple[float, bool]]


def judgements(rows: Sequence[Seen], own_level: bool) -> Iterator[Judgement]:
    """Yield what odds make of rows of one source; the other axes of a machine tell of its level."""
    whole = {(r.machine, str(r.seen.truth)): r for r in rows if not r.seen.without}
    for row in rows:
        key = (row.machine, str(row.seen.truth))
        beside = [r for k, r in whole.items() if k != key and k[0] == row.machine]
        every = [(item_of(x, str(n)), x) for n, r in enumerate([row, *beside]) for x in r.seen.items]
        closures = [Interval(**x["closure"]) if x.get("closure") else None for _, x in every]
        odds = judged_together([i for i, _ in every], closures, in_force(), own_level)[: len(row.seen.items)]
        exact = [reproduced_plain(stage, in_force()) for stage in row.seen.exact]
        answers = [(j, x, answer_of(row.seen, x, whole[key].seen)) for j, x in zip(odds, row.seen.items, strict=True)]
        told = [(j.library, a == LIBRARY) for j, x, a in answers if x["index"] is not None and a is not None]
        named = [x["candidates"][0] for j, x, _ in answers if answer_to(j, DEFAULT) == LIBRARY]
        limits = [(c["effect"], c["actuator"]) for stage in row.seen.exact for c in stage["causes"]]
        status = status_of(odds, exact, in_force().same, DEFAULT) if odds or exact else "no_gap"
        yield Judgement(row, status, [*limits, *((c["effect"], c["site"]) for c in named)], told)


def item_of(row: Mapping[str, Any], number: str) -> Item:
    """Return an item that was kept as plain data, of one of several parts."""
    found = plain_item(row)
    return replace(found, channel=found.channel._replace(actuator=found.channel.actuator + number))


def settled(rows: Sequence[Seen]) -> list[Seen]:
    """Return the rows whose status the label settles: of a withheld effect those where it leaves what is foreign."""
    whole = {(r.machine, str(r.seen.truth)): r.seen for r in rows if not r.seen.without}

    def foreign(row: Seen) -> bool:
        full = whole[row.machine, str(row.seen.truth)]
        return any(answer_of(row.seen, x, full) == OUTSIDE for x in row.seen.items)

    return [r for r in rows if not r.seen.without or foreign(r)]


SORTS: Mapping[str, tuple[str, bool, tuple[str, ...]]] = {
    "right called outside": ("attributed", False, ("outside_library",)),
    "foreign blamed": ("outside_library", False, NAMED),
    "withheld blamed": ("attributed", True, NAMED),
    "alarms": ("no_gap", False, ("outside_library", *NAMED)),
}
"""Mistakes: status of the label, whether an effect is left out, and the answers that are wrong then."""


def shares_of(judged: Sequence[Judgement]) -> list[str]:
    """Return how often each mistake of `SORTS` is made, with its interval."""
    out = []
    for status, without, wrong in SORTS.values():
        said = [j.status for j in judged if (j.row.seen.truth["status"], bool(j.row.seen.without)) == (status, without)]
        k, n = sum(s in wrong for s in said), len(said)
        low, high = wilson(k / n, n) if n else (0.0, 0.0)
        out.append(f"{k} of {n} [{low:.2f}, {high:.2f}]" if n else "-")
    return out


def spread_of(rows: Sequence[Seen]) -> str:
    """Return how far what places leave is from the level of their machine, in logarithms: places with right causes."""
    off: list[float] = []
    for row in (r for r in rows if not r.seen.without and r.seen.truth["status"] == "attributed"):
        left: dict[str, list[float]] = {}
        for x in (x for x in row.seen.items if x["index"] is not None):
            right = answer_of(row.seen, x, row.seen) == LIBRARY
            left.setdefault(x["channel"], []).append(math.log(share_of_whole(x["numbers"])) if right else math.nan)
        off += [float(np.mean(x)) - math.log(row.share) for x in left.values()]
    told = np.array([x for x in off if math.isfinite(x)])
    return f"mean {told.mean():.1f}, standard deviation {told.std():.1f} (n {len(told)})" if len(told) else "none"


def weights() -> str:
    """Return what the weights in force are known by: the first digits of the SHA-256 of their file."""
    return sha256(FILE.read_bytes()).hexdigest()[:12]


def row_of(cells: Sequence[str]) -> str:
    """Return a row of a table in Markdown."""
    return f"| {' | '.join(cells)} |"


def page(kept: Sequence[Seen]) -> str:
    """Return the page of the reference: what odds make of the cases, and of the measured sets."""
    head = ["machines", "level", *SORTS]
    rates, odds, levels = [row_of(head), "|---" * len(head) + "|"], list[str](), list[str]()
    for source in SOURCES:
        rows = settled([r for r in kept if r.source == source])
        if not rows:
            continue
        numbers = sorted({int(r.machine) for r in rows})
        levels.append(f"- {source}, {len(numbers)} of {numbers[0]} to {numbers[-1]}: {spread_of(rows)}")
        for name, own in (("SHER's", False), ("own", True)):
            judged = list(judgements(rows, own))
            rates.append(row_of([source, name, *shares_of(judged)]))
            odds.append(f"- {source}, {name} level: {plain.surprise([c for j in judged for c in j.causes])}")
    sets = [row_of(["measured set", "known causes", "SHER's level", "own level"]), "|---" * 4 + "|"]
    for row in (r for r in kept if r.source == "measured"):
        known = next(m for m in measured.SETS if m.name == row.machine)
        told = [f"{j.status}, {sum(measured.kept(known, j.named))} named" for j in both_levels(row)]
        sets.append(row_of([row.machine, str(len(known.known)), *told]))
    parts = [HEAD, f"Weights in force: `{weights()}`.", "\n".join(rates), "\n".join(odds), SPREAD, "\n".join(levels)]
    return "\n\n".join([*parts, MEASURED, "\n".join(sets)]) + "\n"


def both_levels(row: Seen) -> list[Judgement]:
    """Return what odds make of one machine at the level of the labelled robots, and at its own."""
    return [j for own in (False, True) for j in judgements([row], own)]


def table(options: argparse.Namespace) -> None:
    """Print the page."""
    print(page(list(read(options.folder))), end="")


def draw(folder: Path, source: str, seeds: range) -> None:
    """Keep what is seen of the cases of a source; those that are there are not computed again."""
    for seed in seeds:
        file = folder / source.replace(" ", "_") / f"{seed}.json"
        if file.exists():
            continue
        number = seed // AXES if source == "axes" else seed
        try:
            case = SOURCES[source](seed)
            rows = [seen_of(source, str(number), level(number), case, w) for w in [(), *map(tuple, case.left_out)]]
        except Sher3Error as error:
            print(f"{source} {seed}: left out: {error}", file=sys.stderr)
            rows = []
        write(file, rows)


def draw_all(options: argparse.Namespace) -> None:
    """Draw the cases of every source."""
    for n in range(max(options.cases)):
        for source, cases in zip(SOURCES, options.cases, strict=True):
            each, seed = AXES if source == "axes" else 1, options.first + n
            draw(options.folder, source, range(seed * each, (seed + (n < cases)) * each))


def draw_real(options: argparse.Namespace) -> None:
    """Keep what is seen of the measured sets."""
    for known in measured.SETS:
        file = options.folder / "measured" / f"{known.name}.json"
        if not file.exists():
            machine, runs = measured.opened(known)
            case = plain.Case(machine, runs, plain.label(machine, known.known), [])
            write(file, [seen_of("measured", known.name, 0.0, case, ())])


def main() -> None:
    """Draw, or judge and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("draw", "real", "table"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--cases", type=int, nargs=len(SOURCES), default=[20, 16, 20])
    parser.add_argument("--first", type=int, default=30_000, help="seed")
    options = parser.parse_args()
    {"draw": draw_all, "real": draw_real, "table": table}[options.what](options)


if __name__ == "__main__":
    main()
