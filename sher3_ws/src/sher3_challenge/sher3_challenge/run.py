"""Run a challenge: build, seal, diagnose in other processes that get the case folders alone, score.

The labels stay in this process, as text whose hashes are in the manifest, until every verdict is written.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import yaml
from joblib import delayed
from joblib.externals.loky import ProcessPoolExecutor
from sher3_common.progress import Say, silent

from sher3_challenge.answers.diagnosis import Answers, ask
from sher3_challenge.cases.builder import Request, build_case
from sher3_challenge.cases.plan import KINDS, TARGETS
from sher3_challenge.cases.seal import CASES, LABELS, MANIFEST, hashes
from sher3_challenge.errors import ChallengeError
from sher3_challenge.plants.registry import truth_plant, truth_plants
from sher3_challenge.score.case import CaseScore, score_case
from sher3_challenge.score.outcome import SCORES, Outcome
from sher3_challenge.score.reliability import diagram

VERDICTS = "verdicts"
RELIABILITY = "reliability.png"
MAXIMUM_CASES = 2000
"""Cases of one challenge: an end against slips of the keyboard."""
WITHHELD = "withheld"
ONE_THREAD = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")}
"""Environment of a process: as many cases as processes run at once, so none of them takes a second core."""
Task = tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]
"""What `joblib.delayed` makes: a function, what it is given, and what by name."""


def requests(
    seeds: tuple[int, int],
    kinds: Sequence[str] = (),
    without: str | None = None,
    gap: tuple[float, float] = TARGETS,
    plants: Sequence[str] = (),
    say: Say = silent,
) -> list[Request]:
    """Return the cases of a seed range.

    Args:
        seeds: first seed and the one after the last.
        kinds: kinds of cases, dealt in turn; empty draws them in the standard mix. `withheld` is a single fault whose
            effect the diagnosis must do without.
        without: an effect: every case has it as its fault, and the diagnosis must do without it.
        gap: range of gap over floor of single faults.
        plants: names of truth plants, dealt in turn; empty deals all that are installed. Each plant gets the kinds in
            turn.
        say: is told of plants that are left out.

    Raises:
        ChallengeError: empty or too long range, unknown kind, effect or plant.
    """
    first, last = seeds
    if not 0 < last - first <= MAXIMUM_CASES:
        raise ChallengeError(
            "number of cases out of range",
            value=last - first,
            limit=f"1 to {MAXIMUM_CASES}",
            remedy="give another range of seeds",
        )
    unknown = [kind for kind in kinds if kind not in (*KINDS, WITHHELD)]
    if unknown:
        raise ChallengeError.unknown("no such kind of case", unknown[0], (*KINDS, WITHHELD))
    dealt = [truth_plant(name) for name in plants] if plants else truth_plants(say)
    made = []
    for n, seed in enumerate(range(first, last)):
        turn, truth = n // len(dealt), dealt[n % len(dealt)]
        kind = kinds[turn % len(kinds)] if kinds else None
        if without is not None:
            names = [name for name, known in truth.library.items() if known.effect == without]
            if not names:
                raise ChallengeError.unknown("no such effect", without, truth.effects)
            made.append(Request(seed, "single", names[turn % len(names)], True, gap, truth.name))
        elif kind == WITHHELD:
            made.append(Request(seed, "single", None, True, gap, truth.name))
        else:
            made.append(Request(seed, kind, gap=gap, plant=truth.name))
    return made


def run_challenge(
    out: Path,
    wanted: Iterable[Request],
    *,
    jobs: int = 1,
    baselines: bool = True,
    say: Say = silent,
) -> Outcome:
    """Build, seal, diagnose and score a challenge in the new folder `out`.

    Raises:
        ChallengeError: the folder exists.
    """
    started = time.perf_counter()
    todo = list(wanted)
    if out.exists():
        raise ChallengeError("exists already", value=str(out), remedy="choose another folder")
    say(f"building {len(todo)} cases")
    labels = in_processes(jobs, (delayed(build_case)(request, out / CASES) for request in todo))
    texts = {truth["case"]: yaml.safe_dump(truth, sort_keys=False) for truth in labels}
    sealed = {f"{LABELS}/{name}.yaml": hashlib.sha256(text.encode()).hexdigest() for name, text in texts.items()}
    (out / MANIFEST).write_text(json.dumps(hashes(out / CASES) | sealed, indent=1), encoding="utf-8")
    say(f"diagnosing {len(todo)} cases")
    answers = diagnose_all(out / CASES, labels, jobs=jobs, baselines=baselines)
    (out / VERDICTS).mkdir()
    for name, given in answers.items():
        (out / VERDICTS / f"{name}.json").write_text(json.dumps(given.verdict, indent=1), encoding="utf-8")
    (out / LABELS).mkdir()
    for name, text in texts.items():
        (out / LABELS / f"{name}.yaml").write_text(text, encoding="utf-8")
    errors = {name: given.error for name, given in answers.items() if given.error is not None}
    outcome = Outcome(score_all(labels, answers), time.perf_counter() - started, _range(todo), errors)
    (out / SCORES).write_text(json.dumps(outcome.as_dict(), indent=1), encoding="utf-8")
    rows = outcome.scores["diagnosis"]
    diagram({p: [x for s in rows if s.plant == p for x in s.stated] for p in outcome.plants}, out / RELIABILITY)
    return outcome


def diagnose_all(cases: Path, labels: Sequence[dict[str, Any]], *, jobs: int, baselines: bool) -> dict[str, Answers]:
    """Diagnose cases in other processes, which get a folder and, for withheld cases, the effects to do without."""
    names = [truth["case"] for truth in labels]
    without = [tuple(truth.get("without", ())) for truth in labels]
    tasks = (delayed(ask)(cases / name, left_out, baselines) for name, left_out in zip(names, without, strict=True))
    return dict(zip(names, in_processes(jobs, tasks), strict=True))


def score_all(labels: Sequence[dict[str, Any]], answers: dict[str, Answers]) -> dict[str, list[CaseScore]]:
    """Return the scores by competitor."""
    scores = {"diagnosis": [score_case(truth, answers[truth["case"]].verdict) for truth in labels]}
    for who in sorted({who for given in answers.values() for who in given.baselines}):
        scores[who] = [score_case(truth, answers[truth["case"]].baselines.get(who)) for truth in labels]
    return scores


def in_processes(jobs: int, tasks: Iterable[Task]) -> list[Any]:
    """Return what tasks give, in their order, done in `jobs` other processes, which end then.

    One job still means another process, for the diagnosis must share no memory with the labels, nor with the processes
    that built the cases.
    """
    with ProcessPoolExecutor(max_workers=jobs, env=ONE_THREAD) as processes:
        return list(processes.map(_call, tasks))


def _call(task: Task) -> Any:
    function, given, named = task
    return function(*given, **named)


def _range(todo: Sequence[Request]) -> tuple[int, int]:
    return min(r.seed for r in todo), max(r.seed for r in todo) + 1
