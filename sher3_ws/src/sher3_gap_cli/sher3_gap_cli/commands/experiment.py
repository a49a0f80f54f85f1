"""`sher3 gap experiment`: a design that tells rivals apart, and what its run realised of the prediction."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import (
    Bet,
    RobotFile,
    VerdictFile,
    case_argument,
    check_writable,
    reported,
    require_sher_case,
)

if TYPE_CHECKING:
    from sher3_gap.experiments.design import Experiment
    from sher3_gap.experiments.separation import Separation

RECORD = "give its case too: sher3 gap experiment VERDICT CASE -o motion.csv (.yaml: ROS 2, .xml: MJCF)"
"""What designs a motion for another machine."""
DIAGNOSE = "diagnose the new case: what a motion of another machine came to stands in its verdict"
"""What takes the place of predicted against realised for another machine."""


def experiment(
    verdict: VerdictFile,
    case: Annotated[
        Path | None,
        case_argument("Its case: gives floors and loads; what it ran is not proposed again."),
    ] = None,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", help="Excitation file; of another machine .csv, .yaml (ROS 2) or .xml (MJCF)."),
    ] = Path("experiment.yaml"),
    ran: Annotated[
        Path | None,
        typer.Option(help="Case recorded with the written file: compares what was predicted with what came."),
    ] = None,
    bet: Bet = False,
    robot: RobotFile = None,
    as_json: Json = False,
) -> None:
    """Design the excitation that best tells a verdict's rivals apart; `sher3 gap excite FILE` runs it.

    With the case of another machine: a Fourier series for its axes or joints, within what its records reached.
    """
    from sher3_machines import is_machine_case

    from sher3_gap_cli.printing import bet_lines, with_bets

    with reported(as_json):
        check_writable([output])
        if ran is not None:
            text = realised_command(verdict, output, ran, robot, as_json, bet)
        elif case is not None and is_machine_case(case):
            text = motion_command(verdict, case, output, as_json, bet)
        else:
            text = design_command(verdict, case, output, robot, as_json, bet)
        typer.echo(text if as_json else with_bets(bet_lines(verdict, bet), text))


def motion_command(verdict: Path, case: Path, output: Path, as_json: bool, bet: bool) -> str:
    """Design what to record of another machine, write the file of its motion, if it moves, and return what to print."""
    from sher3_chain.manipulator.causes.confounding import alike_in_motion, beyond_motion
    from sher3_export.excitation.design import TRIED, designed, is_driven
    from sher3_export.excitation.forms import save
    from sher3_export.verdicts import read_verdict
    from sher3_machines import open_case

    (machine, runs), causes = open_case(case), read_verdict(verdict, bet).causes
    open_ones = [c for c in causes if c.rivals]
    shown = {e.id: e.best.why for e in machine.library()}
    unmoved = [{e for alike, _ in alike_in_motion(c) for e in alike} for c in open_ones]
    settling = [
        shown[e] for c, x in zip(open_ones, unmoved, strict=True) for e in c.rivals if e in shown and e not in x
    ]
    besides = [*beyond_motion(causes), *dict.fromkeys(settling)]
    rivals = [f"{' / '.join([c.effect, *c.rivals])} on {c.actuator}" for c in open_ones]
    made = designed(machine, runs) if is_driven(machine) else None
    data: dict[str, Any] = {"file": None, "rivals": rivals, "besides": besides}
    lines = [f"rivals     {'; '.join(rivals) or 'none'}", *(f"record     {text}" for text in besides)]
    if made is not None:
        save(output, made)
        data |= {"file": str(output), "joints": list(made.joints), "seconds": made.motion.seconds}
        data |= {"worst": made.worst, "median": made.median}
        lines += [
            f"motion     {', '.join(made.joints)}: {made.motion.seconds:g} s from rest to rest, to be repeated",
            "within     range, speed and acceleration of the case's records; collisions are not checked: begin slowly",
            f"tells      its worst told constant {made.worst:.2g} times as well as its best told one; the median of "
            f"{TRIED} motions {made.median:.2g} times",
            f"file       {output}; record it, `sher3 gap import` and `diagnose` it",
        ]
    return (
        json.dumps(data) if as_json else "\n".join([*lines, *([] if made or besides else ["record     nothing more"])])
    )


def design_command(verdict: Path, case: Path | None, output: Path, robot: Path | None, as_json: bool, bet: bool) -> str:
    """Design an experiment, write its file and return what to print."""
    from sher3_description import load_robot
    from sher3_gap.case.loading import load_case
    from sher3_gap.excitation.file import save_excitation
    from sher3_gap.experiments.design import design_experiment
    from sher3_gap.simulate.apply import read_verdict

    from sher3_gap_cli.printing import steps

    found = read_verdict(verdict, RECORD, bet)
    runs, model = load_case(require_sher_case(case, RECORD), robot) if case else ([], load_robot(robot))
    with steps() as say:
        made = design_experiment(found, model, say, runs=runs)
    data = experiment_data(made)
    save_excitation(output, made.excitation, data)
    return json.dumps({"file": str(output), **data}) if as_json else experiment_text(made, output)


def realised_command(verdict: Path, experiment: Path, ran: Path, robot: Path | None, as_json: bool, bet: bool) -> str:
    """Judge the runs of an experiment and return what its prediction came to."""
    from sher3_gap.case.loading import load_case
    from sher3_gap.excitation.file import about_excitation
    from sher3_gap.experiments.design import realised
    from sher3_gap.simulate.apply import read_verdict

    asked = read_verdict(verdict, DIAGNOSE, bet)
    about = about_excitation(experiment)
    runs, model = load_case(require_sher_case(ran, DIAGNOSE), robot)
    found = realised(asked, model, runs)
    data = {
        "predicted_separation": about.get("predicted_separation"),
        "spread": about.get("spread"),
        "realised_separation": found.floors,
        "margin": found.margin,
        "closest_rival": found.closest,
        "runs": len(runs),
    }
    return json.dumps(data) if as_json else realised_text(found, about)


def experiment_data(made: Experiment) -> dict[str, Any]:
    """Return an experiment as plain data."""
    predicted = made.predicted
    return {
        "separates": list(made.separates),
        "predicted_separation": predicted.floors,
        "spread": predicted.spread,
        "draws": len(predicted.draws),
        "resolved": predicted.resolved,
        "margin": predicted.margin,
        "closest_rival": predicted.closest,
        "design": made.design,
        "tried": made.tried,
    }


def experiment_text(made: Experiment, output: Path) -> str:
    """Return what was designed and what to expect of it."""
    settings = ", ".join(f"{k} {v}" for k, v in made.design.items())
    predicted = made.predicted
    lines = [
        f"separates  {' / '.join(made.separates)}",
        f"design     {settings} (best of {made.tried} rehearsals)",
        f"predicted  {predicted.floors:.2f} ± {predicted.spread:.2f} floors from {predicted.closest} over "
        f"{len(predicted.draws)} draws: {_outlook(predicted.margin)}",
        f"file       {output}; run it with `sher3 gap excite {output} -o CASE`, then see what came of it with "
        f"`sher3 gap experiment VERDICT -o {output} --ran CASE`",
    ]
    return "\n".join(lines)


def realised_text(found: Separation, about: dict[str, Any]) -> str:
    """Return predicted against realised."""
    expected = about.get("predicted_separation")
    said = "-" if expected is None else f"{expected:.2f} ± {about.get('spread', 0.0):.2f} floors"
    return "\n".join(
        [
            f"predicted  {said}",
            f"realised   {found.floors:.2f} floors from {found.closest}: {_verdict(found.margin)}",
        ]
    )


def _outlook(margin: float) -> str:
    if margin > 1.0:
        return f"{margin:.1f} times what rules a rival out"
    return f"only {margin:.2f} of what rules a rival out; no excitation of the family is expected to separate them"


def _verdict(margin: float) -> str:
    if margin > 1.0:
        return f"{margin:.1f} times what rules a rival out"
    return f"{margin:.2f} of what rules a rival out: not told apart" if margin > 0.0 else "a rival fits better"
