"""`sher3 gap apply` and `compare`: the causes in the simulator, and what is left of the gap."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import (
    Bet,
    Library,
    RobotFile,
    Trust,
    VerdictFile,
    case_argument,
    echo_result,
    reported,
    require_sher_case,
)

if TYPE_CHECKING:
    from sher3_gap.simulate.apply import StageGap
    from sher3_sim import PlantEffect

TAGS = "import both records into one case and tag them (`conditions` in its description): the diagnosis contrasts them"
"""What takes the place of a comparison for another machine."""


def apply(
    verdict: VerdictFile,
    output: Annotated[Path, typer.Option("--output", "-o", help="Effects file to write.")] = Path("effects.yaml"),
    case: Annotated[Path | None, typer.Option(help="Also run this case again and print the gap that is left.")] = None,
    bet: Bet = False,
    robot: RobotFile = None,
    own: Library = None,
    trust: Trust = False,
    as_json: Json = False,
) -> None:
    """Write the effects file that puts a verdict's causes into the simulator; `sher3 up --effects` loads it."""
    from sher3_description import load_robot
    from sher3_effects import add_library
    from sher3_gap.case.loading import load_case
    from sher3_gap.simulate.apply import EXPORT, apply_verdict, compare_case

    from sher3_gap_cli.printing import bet_lines, with_bets

    with reported(as_json):
        add_library(own or [], trust)
        runs, model = load_case(require_sher_case(case, EXPORT), robot) if case else ([], load_robot(robot))
        effects = apply_verdict(verdict, output, model, bet)
        odds = bet_lines(verdict, bet)
        stages = compare_case(runs, model, effects) if runs else []
        data = {"effects": str(output), "count": len(effects), "stages": stages_data(stages), "bets": odds}
        echo_result(as_json, data, with_bets(odds, applied_text(effects, stages, output)))


def compare(
    case: Annotated[Path, case_argument("Case of the robot.")],
    other: Annotated[
        Path,
        case_argument("Case of the corrected simulator, of the same excitations."),
    ],
    robot: RobotFile = None,
    as_json: Json = False,
) -> None:
    """Print per stage how far the robot is from the nominal simulator, and from what another case recorded."""
    from sher3_gap.case.loading import load_case
    from sher3_gap.simulate.apply import compare_cases

    with reported(as_json):
        runs, model = load_case(require_sher_case(case, TAGS), robot)
        stages = compare_cases(runs, model, load_case(require_sher_case(other, TAGS), robot)[0])
        echo_result(as_json, {"stages": stages_data(stages)}, stages_text(stages))


def applied_text(effects: Sequence[PlantEffect], stages: Sequence[StageGap], output: Path) -> str:
    """Return what was written, and the gap per stage before and after."""
    from sher3_diagnosis.words import quantity

    lines = [f"{output}: {len(effects)} effect{'s' * (len(effects) != 1)}"]
    for effect in effects:
        spec = type(effect).specification(effect.actuator)
        values = ", ".join(f"{n} {quantity(v, spec[n].unit)}" for n, v in effect.parameters.items() if v)
        lines.append(f"  {effect.id} on {effect.actuator}: {values}")
    return "\n".join([*lines, *(["", stages_text(stages)] if stages else [])])


def stages_text(stages: Sequence[StageGap]) -> str:
    """Return the gap per stage before and after as a table."""
    from sher3_diagnosis.words import place, quantity, share, words

    lines = [f"{'robot against simulator, rms':<34}{'nominal':>12}{'corrected':>12}{'closed':>9}"]
    for s in stages:
        closed = "-" if s.closure is None else share(s.closure)
        name = f"{words(s.stage).lower()}, {place(s.actuator)}"
        lines.append(f"  {name:<32}{quantity(s.before, s.unit):>12}{quantity(s.after, s.unit):>12}{closed:>9}")
    return "\n".join(lines)


def stages_data(stages: Sequence[StageGap]) -> list[dict[str, object]]:
    """Return the gaps per stage as plain data."""
    return [{**s.__dict__, "closure": s.closure} for s in stages]
