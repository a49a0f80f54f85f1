"""The outcome of a check as JUnit XML and as Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from sher3_public.guard.worse import RULES

from sher3_gap_cli.guard.logs import LogAnswer


def junit(found: Sequence[LogAnswer]) -> str:
    """Return JUnit XML: a suite for each log, a case for each thing that is looked for."""
    root = ElementTree.Element("testsuites", name="sher3 gap check")
    for answer in found:
        failed = {rule: [w.text for w in answer.worse if w.rule == rule] for rule in RULES}
        counts = {"tests": len(RULES), "failures": sum(map(bool, failed.values())), "errors": answer.error is not None}
        numbers = {name: str(int(n)) for name, n in counts.items()}
        suite = ElementTree.SubElement(root, "testsuite", {"name": answer.task.name, **numbers})
        for i, rule in enumerate(RULES):
            case = ElementTree.SubElement(suite, "testcase", classname=answer.task.name, name=rule)
            if answer.error is not None:
                kind = "error" if i == 0 else "skipped"
                ElementTree.SubElement(case, kind, message=str(answer.error))
            elif failed[rule]:
                failure = ElementTree.SubElement(case, "failure", message=f"{RULES[rule]}: {len(failed[rule])}")
                failure.text = "\n".join(failed[rule])
    ElementTree.indent(root)
    return ElementTree.tostring(root, encoding="unicode", xml_declaration=True) + "\n"


def markdown(found: Sequence[LogAnswer]) -> str:
    """Return a summary as a table in Markdown, what is worse first."""
    bad = sum(bool(t.worse) or t.error is not None for t in found)
    title = f"## Gap: {bad} of {len(found)} log{'s' * (len(found) > 1)} worse\n"
    rows = [f"| {_cell(t.task.name)} | {_cell(t.headline or str(t.error))} | {_worse(t)} |" for t in ordered(found)]
    return "\n".join([title, "| log | answer | worse |", "|---|---|---|", *rows]) + "\n"


def ordered(found: Sequence[LogAnswer]) -> list[LogAnswer]:
    """Return logs with errors, then those that are worse, then the others, each by name."""
    return sorted(found, key=lambda t: (t.error is None, not t.worse, t.task.name))


def _worse(answer: LogAnswer) -> str:
    if answer.error is not None:
        return "not diagnosed"
    return "<br>".join(_cell(f"{w.rule}: {w.text}") for w in answer.worse) or "–"


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ")
