"""The challenge: cases are sealed, answered blind one by one, and scored."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

from sher3_common import Sher3Error
from sher3_common.progress import Say, silent

from sher3_arms.answer.diagnosis import answer
from sher3_arms.answer.identification import identified, tools
from sher3_arms.errors import ArmsError, NeverStable
from sher3_arms.score import Scored, names_the_fault, scored
from sher3_arms.truth.cases import seal
from sher3_arms.truth.faults import CABLE, ORDER

SECONDS = 60.0
"""Length of a record, s."""


def run_arms(
    seeds: Sequence[int],
    robots: Sequence[str],
    folder: Path,
    seconds: float = SECONDS,
    say: Say = silent,
    beside: bool = False,
    kinds: Sequence[str] = ORDER,
) -> list[Scored]:
    """Seal, answer and score one case for each seed.

    Args:
        seeds: of the cases.
        robots: names of arms, taken in turn.
        folder: new; keeps cases, labels, verdicts and scores.
        seconds: length of a record, s.
        say: takes a line for each case.
        beside: whether `mujoco.sysid` answers each case too.
        kinds: of fault, taken in turn.

    Raises:
        ArmsError: the folder exists, no such arm or kind, or MuJoCo, `mujoco.sysid` or the wheel with the arms is
            missing.
    """
    unknown = [kind for kind in kinds if kind not in (*ORDER, CABLE)]
    if unknown:
        raise ArmsError.unknown("no such kind of fault", unknown[0], dict.fromkeys((*ORDER, CABLE)))
    if beside:
        tools()
    if folder.exists():
        raise ArmsError(f"{folder}: exists already", value="a folder or file", remedy="choose another --out")
    folder.mkdir(parents=True)
    out = []
    for seed in seeds:
        case = folder / "cases" / f"{seed:05d}"
        try:
            label = seal(seed, robots, case, seconds, kinds)
        except NeverStable as error:
            say(f"{error}; left out")
            continue
        begun = time.perf_counter()
        try:
            verdict = answer(case)
            verdict.write(case / "verdict.json")
        except Sher3Error as error:
            verdict = None
            say(f"{seed}: refused: {error}")
        found = scored(label, verdict, time.perf_counter() - begun)
        if beside:
            other = identified(case)
            found = replace(found, fitted=names_the_fault(label, other.effect, other.place))
            say(f"{seed}: mujoco.sysid: {other.effect} {other.place}")
        out.append(found)
        (folder / "labels").mkdir(exist_ok=True)
        (folder / "labels" / f"{seed:05d}.json").write_text(json.dumps(asdict(label), indent=1), encoding="utf-8")
        say(
            f"{seed}: {found.kind} on {found.joint or 'no joint'} of {found.robot}: "
            f"{found.status} {found.effect} {found.place}{again(label.drawn)}"
        )
    (folder / "scores.json").write_text(json.dumps([c.as_dict() for c in out], indent=1), encoding="utf-8")
    return out


def again(drawn: int) -> str:
    """Return in words how often the fault of a case was drawn again because the arm did not follow its motion."""
    return f" (drawn {drawn} times: unstable before)" if drawn > 1 else ""
