"""Cases and their answers, written to files."""

from __future__ import annotations

import time
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sher3_common.errors import Sher3Error
from sher3_common.progress import Say, silent
from sher3_diagnosis.judge.costs import DEFAULT, Costs
from sher3_diagnosis.verdict import Verdict

from sher3_gap_cli.options import RequestError

if TYPE_CHECKING:
    from sher3_diagnosis import Diagnosis

VERDICT_FILE, REPORT_FILE = "verdict.json", "report.html"


@dataclass(frozen=True)
class Task:
    """One case to diagnose; paths as the worker sees them, `folder` as the user named where the answer goes."""

    case: Path
    robot: Path | None = None
    without: tuple[str, ...] = ()
    report: bool = True
    folder: str = ""
    costs: Costs = DEFAULT

    @property
    def options(self) -> str:
        """What a search for a formula repeats of how the case was diagnosed."""
        return f" --without {','.join(self.without)}" if self.without else ""

    def absolute(self) -> Task:
        """Return it with paths that do not depend on the working folder."""
        robot = None if self.robot is None else self.robot.resolve()
        return replace(self, case=self.case.resolve(), robot=robot, folder="")


@dataclass(frozen=True)
class Answer:
    """What a worker hands back: a verdict, its five lines and a report as text, or the error that stopped it."""

    task: Task
    verdict: Verdict | None = None
    lines: Sequence[tuple[str, str]] = ()
    html: str = ""
    error: Sher3Error | None = None


def answer(task: Task, say: Say = silent) -> Answer:
    """Diagnose one case; input errors come back as the answer, mistakes of ours are raised."""
    from sher3_diagnosis.report.summary import five_lines

    try:
        found = diagnosed(task, say)
    except Sher3Error as error:
        return Answer(task, error=error)
    rests = {e.id: e.leaves_out for e in found.machine.library() if e.leaves_out}
    reporter = found.machine.reporter()
    table, case = reporter.table(found), str(task.case)
    lines = five_lines(found.verdict, reporter, rests, table, case, task.folder, task.options)
    if not task.report:
        return Answer(task, found.verdict, lines)
    say("writing the report")
    return Answer(task, found.verdict, lines, _page(found, task))


def _page(found: Diagnosis[Any], task: Task) -> str:
    from sher3_diagnosis.report.page import render

    return render(found, task.case.resolve().name, folder=task.folder, case=str(task.case), options=task.options)


def diagnosed(task: Task, say: Say) -> Diagnosis[Any]:
    """Diagnose the case of the SHER or of another machine."""
    from sher3_machines import is_machine_case

    if is_machine_case(task.case):
        from sher3_diagnosis import diagnose
        from sher3_machines import open_case

        started = time.perf_counter()
        machine, runs = open_case(task.case)
        return diagnose(machine, runs, task.without, say, started, task.costs)
    from sher3_bags.case_file import case_file

    case_file(task.case)  # what is no case is said where the extra that reads bags is not installed
    from sher3_gap import diagnose_case

    return diagnose_case(task.case, task.robot, task.without, say, task.costs)


def check_effects(without: Sequence[str]) -> tuple[str, ...]:
    """Return the effects to leave out, split at commas; raises RequestError for one that no machine has.

    What the machine of a case lacks the engine refuses.
    """
    from sher3_effects import every

    names, known = tuple(name for entry in without for name in entry.split(",") if name), every()
    for name in names:
        if name not in known:
            raise RequestError("no such effect", value=name, limit=", ".join(known), remedy="see `sher3 gap library`")
    return names


def folders(cases: Collection[Path], out: Path | None) -> dict[Path, Path]:
    """Return the output folder of every case: `out` for one, `out/<case>` for several; by default `gap/<case>`.

    Raises:
        RequestError: two cases would write to one folder.
    """
    if out is not None and len(cases) == 1:
        return {case: out for case in cases}
    root = Path("gap") if out is None else out
    chosen = {case: root / case.resolve().name for case in cases}
    if len(set(chosen.values())) < len(cases):
        names = ", ".join(sorted(str(case) for case in cases))
        raise RequestError("cases of the same name", value=names, remedy="diagnose them with separate --out")
    return chosen


def write_answer(found: Answer, folder: Path) -> list[Path]:
    """Write verdict and report into `folder`; return the files.

    Raises:
        RequestError: the folder cannot be written.
    """
    assert found.verdict is not None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        found.verdict.write(folder / VERDICT_FILE)
        if not found.html:
            return [folder / VERDICT_FILE]
        (folder / REPORT_FILE).write_text(found.html, encoding="utf-8")
    except OSError as error:
        raise RequestError(
            f"{folder}: cannot be written", value=error.strerror, remedy="choose another --out"
        ) from error
    return [folder / VERDICT_FILE, folder / REPORT_FILE]


def as_data(found: Answer, files: Sequence[Path]) -> dict[str, Any]:
    """Return an answer as plain data for `--json`."""
    if found.error is not None:
        return {"case": str(found.task.case), "error": found.error.to_dict()}
    assert found.verdict is not None
    verdict = found.verdict.model_dump(by_alias=True, mode="json")
    return {"case": str(found.task.case), "files": [str(f) for f in files], "verdict": verdict}
