"""`sher3 gap export`: a verdict written into the model of another simulator, checked there, or as ranges."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from sher3_common.commands.options import Json

from sher3_gap_cli.options import (
    Bet,
    Library,
    RequestError,
    Trust,
    VerdictFile,
    check_writable,
    echo_result,
    reported,
    written,
)

TARGETS = "mjcf, urdf, sdf, isaaclab, isaac, mjlab, ros2_control or yaml"
"""Names of targets as the help has them; the table of `sher3_export` is not imported for it."""

if TYPE_CHECKING:
    from sher3_export.check.check import JointGap
    from sher3_export.writing import Exported


def export(
    verdict: VerdictFile,
    to: Annotated[
        str, typer.Option(help="Target: mjcf, urdf, sdf, isaaclab, isaac, mjlab, ros2_control or yaml.")
    ] = "yaml",
    model: Annotated[Path | None, typer.Option(help="Nominal model that the causes are added to.")] = None,
    out: Annotated[Path | None, typer.Option(help="File to write; default exported, with the target's ending.")] = None,
    check: Annotated[
        Path | None, typer.Option(help="Run the MJCF in MuJoCo on this case; without --model it is made of the case.")
    ] = None,
    ranges: Annotated[bool, typer.Option("--ranges", help="Write ranges for randomisation, rivals included.")] = False,
    joint: Annotated[
        list[str] | None, typer.Option(help="AXIS=JOINT where the model has another name; repeat for more.")
    ] = None,
    motor: Annotated[
        list[str] | None, typer.Option(help="MOTOR=JOINT:SHARE,JOINT:SHARE behind a coupling; repeat for more.")
    ] = None,
    bet: Bet = False,
    own: Library = None,
    trust: Trust = False,
    as_json: Json = False,
) -> None:
    """Write the causes of a verdict into a model, and list what its format cannot express.

    Exit codes: 0 written, 2 a file or option is wrong (one sentence says why).
    """
    from sher3_effects import add_library
    from sher3_export.verdicts import read_verdict

    from sher3_gap_cli.printing import bet_lines, with_bets

    with reported(as_json):
        add_library(own or [], trust)
        target = out or Path(f"exported.{'yaml' if ranges else _suffix(to)}")
        check_writable([target])
        given, names, motors = read_verdict(verdict, bet), _names(joint or []), _motors(motor or [])
        data = _ranges(given, check, model, names, motors) if ranges else _model(given, to, check, model, names, motors)
        written(target, data.pop("text"))
        data = {"file": str(target), **data, "bets": bet_lines(verdict, bet)}
        echo_result(as_json, data, with_bets(data["bets"], _text(data)))


def _model(
    given: Any, to: str, check: Path | None, model: Path | None, names: dict[str, str], motors: Any
) -> dict[str, Any]:
    """Return the exported model with what was written, and the gaps that are left where it was checked."""
    from sher3_export.check.check import check as checked
    from sher3_export.writing import export as written

    if check is None:
        return _exported(written(given, to, model, names, motors), [])
    if to != "mjcf":
        raise RequestError("only MJCF is checked in MuJoCo", value=f"--to {to}", limit="mjcf", remedy="use --to mjcf")
    found = checked(given, check, model, names, motors)
    if found.worse:
        told = "; ".join(f"{g.joint}: {g.before:.4g} {g.unit} nominal, {g.after:.4g} exported" for g in found.gaps)
        remedy = (
            "keep the nominal model, or leave a cause out: sher3 gap diagnose CASE --without EFFECT; without --check "
            "the file is written all the same"
        )
        limit = "a position error below the nominal model's"
        raise RequestError(
            "the exported model predicts worse, and is not written", value=told, limit=limit, remedy=remedy
        )
    return _exported(found.exported, found.gaps)


def _exported(done: Exported, gaps: Any) -> dict[str, Any]:
    from sher3_export.changes import in_words

    return {
        "text": done.text,
        "written": in_words(done.applied),
        "not_expressed": [str(text) for text in done.not_expressed],
        "gaps": [gap_data(gap) for gap in gaps],
    }


def _ranges(given: Any, check: Path | None, model: Path | None, names: dict[str, str], motors: Any) -> dict[str, Any]:
    """Return the ranges, and the share of held-out motion they cover where there is a case."""
    from sher3_export.check.coverage import covered
    from sher3_export.ranges import Ranges, worlds_of
    from sher3_export.writing import travels_of

    if check is None:
        ranges = Ranges(worlds_of(given), (), {}, given.identified, given.noise, motors=travels_of(given, motors))
        return {"text": ranges.text(), "ranges": ranges.lines(), "coverage": {}}
    found = covered(given, check, model, names, motors)
    return {"text": found.ranges.text(), "ranges": found.ranges.lines(), "coverage": dict(found.coverage)}


def gap_data(gap: JointGap) -> dict[str, Any]:
    """Return the gap of one joint as plain data."""
    return {**asdict(gap), "closure": gap.closure.model_dump()}


def _text(data: dict[str, Any]) -> str:
    from sher3_diagnosis.words import quantity

    lines = [data["file"]]
    lines += [f"  {text}" for text in (*data.get("written", []), *data.get("ranges", []))]
    lines += [f"  not expressed: {text}" for text in data.get("not_expressed", [])]
    for gap in data.get("gaps", []):
        before, after = (quantity(gap[which], gap["unit"]) for which in ("before", "after"))
        closed = f"{gap['closure']['value']:.1%} closed" if gap["after"] <= gap["before"] else "worse"
        lines.append(f"  MuJoCo, {gap['joint']}: {before} rms nominal, {after} exported, {closed}")
    for name, share in data.get("coverage", {}).items():
        lines.append(f"  {name}: {share:.1%} of held-out motion within the 90 % ranges")
    return "\n".join(lines)


def _names(pairs: list[str]) -> dict[str, str]:
    """Return AXIS=JOINT as a mapping; raises RequestError for any other text."""
    for pair in pairs:
        if pair.count("=") != 1 or not all(pair.split("=")):
            raise RequestError("--joint is no pair", value=pair, limit="AXIS=JOINT", remedy="as in --joint slide=j1")
    return dict(pair.split("=") for pair in pairs)


def _motors(texts: list[str]) -> dict[str, dict[str, float]] | None:
    """Return MOTOR=JOINT:SHARE,... as a mapping; raises RequestError for any other text."""
    found: dict[str, dict[str, float]] = {}
    for text in texts:
        name, _, shares = text.partition("=")
        try:
            found[name] = {joint: float(share) for joint, share in (x.split(":") for x in shares.split(","))}
        except ValueError as error:
            limit = "MOTOR=JOINT:SHARE,JOINT:SHARE"
            raise RequestError(
                "--motor is none", value=text, limit=limit, remedy="as in --motor b=a:0.5,b:1"
            ) from error
    return found or None


def _suffix(to: str) -> str:
    from sher3_export.targets.plain import Plain
    from sher3_export.writing import TARGETS as KINDS

    return KINDS.get(to, Plain).suffix
