"""`sher3 gap check`: whether the gap of a robot is worse than it was."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import BAD_INPUT, RequestError, check_writable, echo_result, effects, reported, written

if TYPE_CHECKING:
    from sher3_public.guard.baseline import Baseline

    from sher3_gap_cli.guard.logs import Log, LogAnswer

WORSE = 1
"""Exit code when something is worse than the baseline."""
EXAMPLE = "sher3 gap check log.npz robot.xml --baseline verdict.json"


def check(
    paths: Annotated[list[Path], typer.Argument(help="Logs, files or folders; then the model: MJCF, URDF or YAML.")],
    baseline: Annotated[Path | None, typer.Option(help="verdict.json, or what --record wrote.")] = None,
    record: Annotated[Path | None, typer.Option(help="Write what the logs say as the baseline.")] = None,
    allow: Annotated[float, typer.Option(min=0.0, help="Share by which a size or a floor may rise.")] = 0.2,
    junit: Annotated[Path | None, typer.Option(help="JUnit XML to write.")] = None,
    markdown: Annotated[Path | None, typer.Option(help="Summary in Markdown to write.")] = None,
    without: Annotated[
        list[str] | None, typer.Option(help="Leave this effect out; repeat for more.", autocompletion=effects())
    ] = None,
    jobs: Annotated[int, typer.Option(min=1, help="Logs at a time on this machine.")] = 1,
    dask: Annotated[str, typer.Option(help="Address of a Dask scheduler that diagnoses the logs.")] = "",
    as_json: Json = False,
) -> None:
    """Hold logs of a robot against a baseline: a new cause, a cause that grew beyond its interval, a higher floor.

    Exit codes: 0 nothing is worse, 1 something is worse, 2 a log, the model, the baseline or an option is wrong.
    """
    from sher3_gap_cli.guard import pages

    with reported(as_json):
        check_writable([record, junit, markdown])
        tasks, known = _tasks(paths, without or [], baseline, record), None if baseline is None else _read(baseline)
        found = [_compared(t, known, allow) for t in _answers(tasks, jobs, dask)]
        for target, text in ((junit, pages.junit), (markdown, pages.markdown)):
            if target is not None:
                written(target, text(found))
        if record is not None and all(t.error is None for t in found):
            written(record, _baseline(found))
    echo_result(as_json, {"logs": [_data(t) for t in found]}, _text(found))
    if any(t.error is not None for t in found):
        raise typer.Exit(BAD_INPUT)
    if any(t.worse for t in found):
        raise typer.Exit(WORSE)


def _tasks(paths: Sequence[Path], without: list[str], baseline: Path | None, record: Path | None) -> list[Log]:
    """Return the logs by name; raises RequestError for what makes no check."""
    from sher3_gap_cli.answers import check_effects
    from sher3_gap_cli.guard.logs import Log

    if len(paths) < 2:
        raise RequestError("logs and a model are needed", value=len(paths), remedy=EXAMPLE)
    if (baseline is None) == (record is None):
        raise RequestError("a baseline to compare with, or one to record", remedy="give --baseline or --record")
    tasks = {log.name: log for log in (Log(path, paths[-1], check_effects(without)) for path in sorted(paths[:-1]))}
    if len(tasks) < len(paths) - 1:
        names = ", ".join(map(str, paths[:-1]))
        raise RequestError("logs of the same name", value=names, remedy="check them one by one")
    return list(tasks.values())


def _answers(tasks: Sequence[Log], jobs: int, dask: str) -> list[LogAnswer]:
    """Return what the logs say, in their order."""
    from sher3_gap_cli.guard.logs import answered
    from sher3_gap_cli.printing import bar
    from sher3_gap_cli.workers import run_here, run_on_dask

    found: dict[Log, LogAnswer] = {}
    with bar(len(tasks)) as (say, advance):
        for one in run_on_dask(answered, tasks, dask) if dask else run_here(answered, tasks, jobs, say):
            found[one.task] = one
            say(f"{one.task.name} is read")
            advance("", "")
    return [found[task] for task in tasks]


def _read(path: Path) -> Baseline:
    from sher3_public.guard.baseline import read_baseline

    return read_baseline(path)


def _compared(answer: LogAnswer, baseline: Baseline | None, allow: float) -> LogAnswer:
    """Return an answer with what is worse than the baseline."""
    from sher3_public.guard.worse import worse

    if baseline is None or answer.entry is None:
        return answer
    return replace(answer, worse=tuple(worse(baseline.entry(answer.task.name), answer.entry, allow)))


def _baseline(found: Sequence[LogAnswer]) -> str:
    from sher3_public.guard.baseline import Baseline

    return Baseline(logs={t.task.name: t.entry for t in found if t.entry is not None}).to_json()


def _data(answer: LogAnswer) -> dict[str, Any]:
    if answer.entry is None:
        return {"log": str(answer.task.log), "error": answer.error.to_dict() if answer.error is not None else None}
    verdict = answer.entry.verdict.model_dump(by_alias=True, mode="json")
    return {"log": str(answer.task.log), "worse": [w._asdict() for w in answer.worse], "verdict": verdict}


def _text(found: Sequence[LogAnswer]) -> str:
    lines = []
    for answer in found:
        lines.append(f"{answer.task.name}: {answer.error or answer.headline}")
        lines += [f"  worse, {w.rule}: {w.text}" for w in answer.worse]
    return "\n".join(lines)
