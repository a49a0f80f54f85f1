"""Progress of the commands, and the answer of a diagnosis as text."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from sher3_common.progress import Say
from sher3_diagnosis.bet import bets_text
from sher3_diagnosis.verdict import Verdict

from sher3_gap_cli.answers import Answer

BAR, STEP, STATUS = 20, 60, 100
"""Width of the bar and of the texts beside it, characters."""

Done = Callable[[Answer, str], None]


@contextmanager
def bar(total: int) -> Iterator[tuple[Say, Callable[[str, str], None]]]:
    """Show progress on stderr; yields `say(step)`, and `advance(text, said)`: one more is done.

    `text` goes to stdout, `said` to stderr; either may be empty.
    """
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(BAR),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True) as shown:
        task = shown.add_task("diagnosing", total=total)

        def say(step: str) -> None:
            shown.update(task, description=step[:STEP])
            if not console.is_terminal:
                console.print(f"  {step}", highlight=False, markup=False)

        def advance(text: str, said: str) -> None:
            shown.advance(task)
            if said:
                console.print(said, highlight=False, markup=False, soft_wrap=True)
            if text:
                shown.stop()
                print(text, flush=True)
                shown.start()

        yield say, advance


@contextmanager
def progress(total: int) -> Iterator[tuple[Say, Done]]:
    """Show progress on stderr; yields `say(step)` and `done(answer, text)`, which prints the text on stdout."""
    with bar(total) as (say, advance):

        def done(found: Answer, text: str) -> None:
            error = "" if found.error is None else f"sher3: {_placed(found)}"
            advance("" if error else text, error)

        yield say, done


def _placed(found: Answer) -> str:
    """Return the error of an answer with its case in front, where the error does not begin with it itself."""
    case, said = str(found.task.case), str(found.error)
    return said if said.startswith(case) else f"{case}: {said}"


def summary(found: Answer, files: Sequence[Path], named: bool) -> str:
    """Return the five lines of an answer, with the case's name before them when there are several."""
    if found.verdict is None:
        return ""
    lines = [f"{found.task.case}"] if named else []
    written = ", ".join(str(f) for f in files)
    notes = [("note", note) for note in found.verdict.notes]
    labelled = [*found.lines, *notes, ("files", written)]
    return "\n".join([*lines, *(f"{label:<8} {text}" for label, text in labelled)])


def bet_lines(verdict: Path, bet: bool) -> list[str]:
    """Return what is bet on at each place of a verdict file, and its odds; nothing where nobody bets."""
    return bets_text(Verdict.read(verdict)) if bet else []


def with_bets(lines: Sequence[str], text: str) -> str:
    """Return a text below the bets that it rests on."""
    return "\n".join([*(f"bet on     {line}" for line in lines), text])


@contextmanager
def steps() -> Iterator[Say]:
    """Show the steps of one task on stderr."""
    console = Console(stderr=True)
    with console.status("working") as status:

        def say(step: str) -> None:
            status.update(step[:STATUS])
            if not console.is_terminal:
                console.print(f"  {step}", highlight=False, markup=False)

        yield say
