"""The evidence of one labelled case, with its whole library and without its effect, as plain data."""

from __future__ import annotations

import json
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from sher3_common import FileError, read_text, read_yaml
from sher3_common.progress import silent
from sher3_description import Robot
from sher3_diagnosis.finding import ExactFinding, Finding, Item
from sher3_diagnosis.flow import find
from sher3_diagnosis.judge.items import items_of
from sher3_diagnosis.machine import Machine
from sher3_gap.signals import RunSignals

from sher3_challenge.cases.seal import CASES, LABELS

LABEL = "truth.yaml"
VERSION = 9
"""Of the evidence: what another version told is refused."""


@dataclass(frozen=True)
class Observation:
    """What the engine says of one case, before it is judged.

    Attributes:
        plant: where it came from; case: its name with that of its folder.
        truth: its label.
        without: effects that were left out of the library.
        items: the causes and gaps, plain: channel, numbers, candidates; of a cause its family and closure too.
        exact: the exact stages: stage, actuator, closure and causes.
        places: channels with a gap, most significant first.
        own_level: whether the machine tells by itself how imperfect it is (`Policy.own_level`).
    """

    plant: str
    case: str
    truth: dict[str, Any]
    without: tuple[str, ...]
    items: tuple[dict[str, Any], ...]
    exact: tuple[dict[str, Any], ...]
    places: tuple[str, ...]
    own_level: bool

    @property
    def ratio(self) -> float | None:
        """Largest gap over floor by the label's oracle; None for exact stages and healthy cases."""
        found = [x["gap_over_floor"] for x in (self.truth.get("oracle") or {}).values() if x.get("gap_over_floor")]
        return max(found) if found and self.truth["effects"] else None


def without_evidence(seen: Observation, name: str) -> Observation:
    """Return an observation of which one piece of evidence is not told."""
    items = ({**x, "numbers": {n: v for n, v in x["numbers"].items() if n != name}} for x in seen.items)
    return replace(seen, items=tuple(items))


def labelled(folder: Path) -> Iterator[Path]:
    """Yield the cases below a folder that have a label: beside their runs, or as a challenge keeps it."""
    for case in sorted(folder.rglob("case.yaml")):
        if label_of(case.parent).exists():
            yield case.parent


def label_of(case: Path) -> Path:
    """Return where the label of a case is, or would be."""
    beside = case / LABEL
    return beside if beside.exists() else case.parent.parent / LABELS / f"{case.name}.yaml"


def name_of(case: Path) -> str:
    """Return the name of a case with that of its folder: cases of two folders may bear one name."""
    folder = case.parent.parent if case.parent.name == CASES else case.parent
    return f"{folder.name}_{case.name}"


def truth_of(case: Path) -> dict[str, Any]:
    """Return the label of a case; that of a withheld effect as of the fault that it is."""
    truth: dict[str, Any] = read_yaml(label_of(case))
    if not truth.get("without"):
        return truth
    effects = [{**e, "family": e.get("withheld", e["family"])} for e in truth["effects"]]
    return {**truth, "status": "attributed", "kind": "single", "effects": effects, "without": []}


def plant_of(case: Path) -> str | None:
    """Return the truth plant that the label of a case names; None where it names none."""
    named: str | None = read_yaml(label_of(case)).get("plant")
    return named


def observations(plant: str, case: Path, kept: Path | None = None) -> list[Observation]:
    """Return the observations of a case: with the whole library, and without the effect of a single fault.

    Args:
        plant: name of the truth plant.
        case: folder with its label.
        kept: file that holds them from one call to the next.
    """
    if kept is not None and (found := stored(kept)):
        return found
    truth = truth_of(case)
    found = _observed(plant, case, truth)
    if kept is not None:
        keep(found, kept)
    return found


def keep(found: Sequence[Observation], file: Path) -> None:
    """Write observations of one case."""
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps({"version": VERSION, "rows": [asdict(o) for o in found]}), encoding="utf-8")


def stored(file: Path) -> list[Observation]:
    """Return the observations of a file, none where it is not there; raises FileError for those of another version."""
    if not file.exists():
        return []
    kept = json.loads(read_text(file))
    if kept.get("version") != VERSION:
        remedy = "delete it: what it tells is computed again"
        raise FileError(
            "holds evidence of another version", path=file, value=kept.get("version"), limit=VERSION, remedy=remedy
        )
    return [_again(row) for row in kept["rows"]]


def _again(row: dict[str, Any]) -> Observation:
    listed: dict[str, Any] = {name: tuple(row[name]) for name in ("without", "items", "exact", "places")}
    return Observation(**{**row, **listed})


def _observed(plant: str, case: Path, truth: dict[str, Any]) -> list[Observation]:
    from sher3_gap.case.loading import load_case

    return observed(plant, name_of(case), truth, *load_case(case))


def observed(plant: str, name: str, truth: dict[str, Any], runs: list[RunSignals], robot: Robot) -> list[Observation]:
    """Return the observations of a case of SHER whose runs are at hand."""
    from sher3_gap.sher import Sher

    return observed_on(Sher(robot), plant, name, truth, runs, _libraries(truth))


def observed_on(
    machine: Machine,
    plant: str,
    name: str,
    truth: dict[str, Any],
    runs: Sequence[Any],
    libraries: Sequence[Collection[str]],
) -> list[Observation]:
    """Return the observations of a case of any machine, one for each collection of effects to leave out."""
    parts = machine.gather(runs)
    out = []
    for without in libraries:
        findings = [find(machine, part, without, silent).with_all for part in parts]
        exact = machine.exact(runs, parts, without)
        out.append(observed_findings(machine, findings, exact, plant, name, truth, without))
    return out


def observed_findings(
    machine: Machine,
    findings: Sequence[Finding],
    exact: Sequence[ExactFinding],
    plant: str,
    name: str,
    truth: dict[str, Any],
    without: Collection[str],
) -> Observation:
    """Return the observation of a case from what was found, with every cause."""
    return Observation(
        plant,
        name,
        truth,
        tuple(without),
        tuple(_plain(finding, item) for finding in findings for item in items_of(finding)),
        tuple(_stage(stage) for stage in exact),
        tuple(str(c) for finding in findings for c in finding.significant),
        machine.policy.own_level,
    )


def _libraries(truth: dict[str, Any]) -> list[Collection[str]]:
    """Effects to leave out: none, and the one of a single fault."""
    effects = truth["effects"]
    single = truth["status"] == "attributed" and len(effects) == 1
    return [(), (effects[0]["effect"],)] if single else [()]


def _plain(finding: Finding, item: Item) -> dict[str, Any]:
    row: dict[str, Any] = {
        "channel": str(item.channel),
        "index": item.index,
        "numbers": {name: float(x) for name, x in item.numbers.items()},
        "candidates": [asdict(c) for c in item.candidates],
    }
    if item.index is not None:
        cause = finding.cause_of(item.index)
        row |= {"family": cause.family, "stage": cause.stage, "closure": cause.closure.model_dump()}
    return row


def _stage(stage: ExactFinding) -> dict[str, Any]:
    return {
        "stage": stage.where.stage,
        "actuator": stage.where.actuator,
        "closure": stage.closure.value,
        "causes": [{"effect": c.effect, "family": c.family, "actuator": c.actuator} for c in stage.causes],
    }


def gathered(plants: Mapping[str, Sequence[Path]], kept: Path, jobs: int = 1) -> list[Observation]:
    """Return the observations of all cases of all plants; those in `kept` are not computed again."""
    from joblib import Parallel, delayed

    tasks = [
        delayed(observations)(plant, case, kept / plant / f"{name_of(case)}.json")
        for plant, cases in plants.items()
        for case in cases
    ]
    found: list[list[Observation]] = Parallel(n_jobs=jobs)(tasks) if jobs > 1 else [t[0](*t[1]) for t in tasks]
    return [o for rows in found for o in rows]
