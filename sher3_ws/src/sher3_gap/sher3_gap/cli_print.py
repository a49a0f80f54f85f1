"""What the commands of `sher3 gap` print."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from sher3_sim import Effect

from sher3_gap.apply import StageGap
from sher3_gap.cli_diagnose import Answer, RequestError
from sher3_gap.library import LIBRARY, LibraryEffect

Done = Callable[[Answer, str], None]


@contextmanager
def progress(total: int) -> Iterator[tuple[Callable[[str], None], Done]]:
    """Show progress on stderr; yields `say(step)` and `done(answer, text)`, which prints the text on stdout."""
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(20),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("diagnosing", total=total)

        def say(step: str) -> None:
            bar.update(task, description=step[:60])
            if not console.is_terminal:
                console.print(f"  {step}", highlight=False, markup=False)

        def done(found: Answer, text: str) -> None:
            bar.advance(task)
            if found.error is not None:
                console.print(f"error: {found.task.case}: {found.error}", highlight=False, markup=False, soft_wrap=True)
            elif text:
                bar.stop()
                print(text, flush=True)
                bar.start()

        yield say, done


def summary(found: Answer, files: Sequence[Path], named: bool) -> str:
    """Return the five lines of an answer, with the case's name before them when there are several."""
    if found.verdict is None:
        return ""
    from sher3_gap.report.summary import five_lines

    lines = [f"{found.task.case}"] if named else []
    lines += [f"{label:<8} {text}" for label, text in five_lines(found.verdict)]
    written = ", ".join(str(f) for f in files)
    return "\n".join([*lines, *(f"{'note':<8} {note}" for note in found.verdict.notes), f"{'files':<8} {written}"])


def applied_text(effects: Sequence[Effect], stages: Sequence[StageGap], output: Path) -> str:
    """Return what was written, and the gap per stage before and after."""
    from sher3_gap.report.style import quantity

    lines = [f"{output}: {len(effects)} effect{'s' * (len(effects) != 1)}"]
    for effect in effects:
        spec = type(effect).specification(effect.actuator)
        values = ", ".join(
            f"{n} {quantity(v, spec[n].unit.replace(' ', '*'))}" for n, v in effect.parameters.items() if v
        )
        lines.append(f"  {effect.id} on {effect.actuator}: {values}")
    return "\n".join([*lines, *(["", stages_text(stages)] if stages else [])])


def stages_text(stages: Sequence[StageGap]) -> str:
    """Return the gap per stage before and after as a table."""
    from sher3_gap.report.style import quantity, share

    lines = [f"{'robot against simulator, rms':<34}{'nominal':>12}{'corrected':>12}{'closed':>9}"]
    for s in stages:
        closed = "-" if s.closure is None else share(s.closure)
        name = f"{s.stage.replace('_', ' ')}, {s.actuator}"
        lines.append(f"  {name:<32}{quantity(s.before, s.unit):>12}{quantity(s.after, s.unit):>12}{closed:>9}")
    return "\n".join(lines)


@contextmanager
def steps() -> Iterator[Callable[[str], None]]:
    """Show the steps of one task on stderr."""
    console = Console(stderr=True)
    with console.status("working") as status:

        def say(step: str) -> None:
            status.update(step[:100])
            if not console.is_terminal:
                console.print(f"  {step}", highlight=False, markup=False)

        yield say


def library_data(which: str = "") -> list[dict[str, Any]]:
    """Return effects as plain data; `which` is an id or a family.

    Raises:
        RequestError: neither.
    """
    chosen = [e for e in LIBRARY.values() if which in ("", e.id, e.family)]
    if not chosen:
        known = ", ".join([*sorted({e.family for e in LIBRARY.values()}), *LIBRARY])
        raise RequestError("no such effect or family", value=which, limit=known)
    return [_effect_data(e) for e in sorted(chosen, key=lambda e: (e.family, e.id))]


def _effect_data(effect: LibraryEffect) -> dict[str, Any]:
    from sher3_sim import EFFECTS

    kind = EFFECTS[effect.id]
    spec = kind.specification(kind.places[0])
    bounds = {n: {"unit": s.unit, "low": s.low, "high": s.high, "text": s.text} for n, s in spec.items()}
    return {
        "effect": effect.id,
        "family": effect.family,
        "stage": effect.stage,
        "sites": list(kind.places),
        "explanation": effect.explanation,
        "parameters": bounds,
        "siblings": dict(effect.siblings),
    }


def library_text(rows: Sequence[dict[str, Any]]) -> str:
    """Return the effects as text, by family."""
    lines: list[str] = []
    for row in rows:
        lines.append(f"{row['effect']}  ({row['family']}, {row['stage']}; on {', '.join(row['sites'])})")
        lines += textwrap.wrap(row["explanation"], 110, initial_indent="  ", subsequent_indent="  ")
        for name, p in row["parameters"].items():
            lines.append(f"    {name} [{p['unit']}] {p['low']:g} … {p['high']:g}: {p['text']}")
        for sibling, why in row["siblings"].items():
            lines.append(f"    not {sibling}: {why}")
        lines.append("")
    return "\n".join(lines).rstrip()
