"""The answer in words: one headline and five lines, for the terminal and the top of the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from sher3_diagnosis.report.odds import name_of, odds, parameter_text, significant, sized
from sher3_diagnosis.report.odds import shown_parameters as shown_parameters
from sher3_diagnosis.reporter import Reporter, Table
from sher3_diagnosis.thresholds import REMAINDER, WITHIN
from sher3_diagnosis.verdict import Cause, Interval, Noise, Verdict
from sher3_diagnosis.words import listed, lower, place, quantity, ratio_text, share, words

LEFT_OVER = 1.2
"""Rms that is left, over the floor, from which the headline says what it is. A convention of the words."""

TINY = 1e-300
"""Floor in place of none."""

WORTH_TRYING = 0.1
"""Probability of the best bet from which the next line tries it although something else is more probable."""


UNJUDGED = "not judged"
"""How the note begins that lists what was recorded and not judged."""


def headline(verdict: Verdict, rests: Mapping[str, str] = MappingProxyType({})) -> str:
    """Return the answer as one sentence: the finding, its size, and how much of the gap it is.

    Args:
        verdict: of any machine.
        rests: effect id -> what its law leaves out, where its page says so.
    """
    names = [name_of(c) for c in verdict.causes]
    if verdict.status == "no_gap":
        unjudged = next((note for note in verdict.notes if note.startswith(UNJUDGED)), "")
        where, rest = (" where it was judged", f"; {unjudged}") if unjudged else ("", "")
        return f"No gap{where}: the machine does what its model says, to within its own repeatability{rest}."
    spoken = odds(verdict)
    open_still = _not_explained(verdict)
    if spoken:
        return _sentence(f"{spoken}{open_still}.")
    if verdict.status == "attributed":
        return _sentence(f"{_finding(verdict)}: {_share(verdict)}{open_still or _rest(verdict, rests)}.")
    if verdict.status == "under_excited":
        open_ones = [f"{name_of(c)} or {listed([lower(r) for r in c.rivals])}" for c in verdict.causes if c.rivals]
        return _sentence(f"{listed(open_ones or names)}: these runs cannot tell.")
    left = verdict.unexplained
    where = "" if left is None else f" in {lower(left.stage)}, {place(left.actuator)}"
    if verdict.causes:
        rest = f"no effect of the library explains the rest{where}"
        return _sentence(f"{_finding(verdict)}: {_share(verdict)}; {rest}.")
    return f"No effect of the library explains the gap{where}."


def five_lines(
    verdict: Verdict,
    reporter: Reporter[Any],
    rests: Mapping[str, str] = MappingProxyType({}),
    table: Table | None = None,
    case: str = "CASE",
    folder: str = "",
    options: str = "",
) -> list[tuple[str, str]]:
    """Return (label, text) of the five lines: verdict, where, cause, closure, next; with a table a cause for each row.

    Args:
        verdict: of any machine.
        reporter: of the machine.
        rests: as in `headline`.
        table: of the causes, where the machine has one.
        case: its folder.
        folder: where its verdict is written.
        options: of the diagnosis; all three as in `command`, so that the next line can be typed as it stands.
    """
    causes = ["; ".join(cause_text(c) for c in verdict.causes) or _unexplained_text(verdict)]
    return [
        ("verdict", f"{verdict.status}: {headline(verdict, rests)}"),
        ("where", _where(verdict)),
        *(("cause", text) for text in (causes if table is None else table.lines())),
        ("closure", _closure(verdict, reporter.end)),
        ("next", _next(verdict, reporter, case, folder, options)),
    ]


def cause_text(cause: Cause) -> str:
    """Return a cause with every parameter that differs from zero, its first one where none does, and its rivals."""
    text = words(name_of(cause))
    known = list(shown_parameters(cause).items())
    for name, p in [(n, p) for n, p in known if significant(p)] or known[:1]:
        text += f", {name.replace('_', ' ')} {parameter_text(p)}"
    return text + (f" [or {', '.join(words(r).lower() for r in cause.rivals)}]" if cause.rivals else "")


def noise_text(noise: Sequence[Noise]) -> str:
    """Return the noise of every reading, place by place."""
    each = {x.actuator: [y for y in noise if y.actuator == x.actuator] for x in noise}
    said = (
        f"{place(name)} " + ", ".join(f"{x.reading} {quantity(x.deviation, x.unit)}" for x in found)
        for name, found in each.items()
    )
    return "; ".join(said)


def closure_text(value: Interval) -> str:
    """Return a closure with its interval."""
    if value.low is None:
        return share(value.value)
    return f"{share(value.value)} ({share(value.low)} … {share(value.high)})"


def _finding(verdict: Verdict) -> str:
    """Return the causes with their sizes; a comma keeps a size to its cause."""
    each = [sized(c) for c in verdict.causes]
    return listed([s + "," * (i == len(each) - 2 and "," in s) for i, s in enumerate(each)])


def _share(verdict: Verdict) -> str:
    """Return how much of the gap the causes are: of the first place, or where they act if they take nothing off it."""
    own = verdict.causes[0].closure
    first = verdict.closure.stage or own
    return f"{share(first.value)} of the gap" if first.value > 0.0 else f"{share(own.value)} of the gap there"


def _rest(verdict: Verdict, rests: Mapping[str, str]) -> str:
    """Return what the rest is, where one is left."""
    left = verdict.residual
    if left is None or left.gap <= LEFT_OVER * left.floor:
        return ""
    if len(verdict.causes) > 1:
        return "; the rest is what their laws leave out"
    return f"; the rest is {rests.get(verdict.causes[0].effect) or 'what its law leaves out'}"


def _not_explained(verdict: Verdict) -> str:
    """Return what named causes leave of their gaps, where that is more than a known cause may; most floors first."""
    bets = [(p, p.bet) for p in verdict.places if verdict.status == "attributed" and p.bet is not None]
    left = [
        (b.residual.gap / max(p.floor, TINY), 1.0 - b.closure.value, p)
        for p, b in bets
        if b.closure is not None and b.residual is not None and b.closure.value < 1.0 - REMAINDER
    ]
    far = sorted((x for x in left if x[0] > WITHIN), key=lambda x: -x[0])
    each = [f"{share(rest)} at {place(p.actuator)} ({ratio_text(floors)} times its floor)" for floors, rest, p in far]
    return f"; not explained: {listed(each)}" if each else ""


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _where(verdict: Verdict) -> str:
    if not verdict.where:
        return "every recorded stage is at its floor"
    first = verdict.where[0]
    ratio = ratio_text(first.gap / first.floor) if first.floor > 0 else "≫ 1000"
    text = f"{words(first.stage).lower()}, {place(first.actuator)}: {quantity(first.gap, first.unit)} rms, "
    text += f"{ratio} times the floor, {first.regime}"
    more = len(verdict.where) - 1
    return text + (f" (and {more} more place{'s' * (more > 1)})" if more else "")


def _unexplained_text(verdict: Verdict) -> str:
    if verdict.unexplained is None:
        return "none needed"
    alike = [
        f"{lower(i.effect)} on {place(i.actuator)} ({share(i.closure.value)})" for i in verdict.unexplained.imitated_by
    ]
    nearest = f", though {listed(alike)} imitate{'s' * (len(alike) == 1)} it" if alike else ""
    return f"none of the library{nearest}; what is left: {verdict.unexplained.signature}"


def _closure(verdict: Verdict, end: str) -> str:
    parts = []
    for name, value in (("stage", verdict.closure.stage), (end, verdict.closure.tip)):
        if value is not None and verdict.causes:
            parts.append(f"{name} {closure_text(value)}")
    bet = verdict.places[0].bet if verdict.places and not verdict.causes else None
    if bet is not None and bet.closure is not None:
        parts.append(f"{closure_text(bet.closure)} with the best bet, {name_of(bet.causes[0])}")
    if verdict.residual is not None and verdict.causes:
        r = verdict.residual
        parts.append(f"left {quantity(r.gap, r.unit)} over a floor of {quantity(r.floor, r.unit)}")
    return ", ".join(parts) or ("nothing to close" if verdict.status == "no_gap" else "nothing, without a cause")


def command(
    verdict: Verdict, reporter: Reporter[Any], case: str, folder: str = "", options: str = ""
) -> tuple[str, str] | None:
    """Return the command that goes on from a verdict and what it does; None where there is none.

    Args:
        verdict: of the case.
        reporter: of the machine: whether the project simulates it, and what takes its causes.
        case: its folder.
        folder: where the verdict was written; default where `sher3 gap diagnose` writes it.
        options: `--without ...` of the diagnosis, which a search for a formula repeats.
    """
    simulated, target = reporter.simulated, reporter.target
    file = _file(case, folder)
    if verdict.status == "attributed" and simulated:
        line = f"sher3 gap apply {file} -o corrected.yaml --case {case}"
        return line, "puts the causes into the simulator and prints the gap that is left"
    if verdict.status == "attributed":
        return f"sher3 gap export {file} {target}", "writes the causes for your own simulator"
    if verdict.status == "under_excited" and simulated:
        return f"sher3 gap experiment {file} {case}", "designs the motion that tells the rivals apart"
    bet = verdict.places[0].bet if verdict.places else None
    if verdict.status == "outside_library" and bet is not None and bet.probability >= WORTH_TRYING:
        tries = f"apply {file} -o corrected.yaml --case {case}" if simulated else f"export {file} {target}"
        return f"sher3 gap {tries} --bet", f"tries the best bet, {share(bet.probability)}"
    if verdict.status == "outside_library" and reporter.formulas:
        return f"sher3 gap discover {case}{options} --save found.yaml", "looks for a formula that explains it"
    return None


def _next(verdict: Verdict, reporter: Reporter[Any], case: str, folder: str, options: str) -> str:
    e = verdict.next_experiment
    if verdict.unseparated_rivals:
        rivals = " / ".join(words(i).lower() for i in verdict.unseparated_rivals)
        return f"no experiment that was rehearsed tells {rivals} apart"
    if e is not None:
        added = f", with {e.added}," if e.added else ""
        expected = "" if e.expected_odds is None else f"; expected odds {share(e.expected_odds)}"
        bet = verdict.places[0].bet if verdict.places else None
        separates = e.expected_odds is None or bet is None or e.expected_odds > bet.probability
        apart = f"{' / '.join(words(i).lower() for i in e.separates)} apart{expected}"
        tells = f"{e.excitation}{added} {'tells' if separates else 'hardly tells'} {apart}"
        return f"`sher3 gap experiment {_file(case, folder)} {case}`: {tells}" if reporter.simulated else tells
    line = command(verdict, reporter, case, folder, options)
    return "none" if line is None else f"`{line[0]}` {line[1]}"


def _file(case: str, folder: str) -> str:
    return f"{folder or f'gap/{case}'}/verdict.json"
