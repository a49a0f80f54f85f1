"""The labelled practice cases of the recorded-run contract, diagnosed and scored, where they are at hand."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path

import pytest
from sher3_gap import diagnose_case
from sources import ROOT

SHARED = Path(os.environ.get("SHER3_SHARED", ROOT.parent / "shared")) / "contract"
CASES = sorted((SHARED / "practice").glob("case_*"))
pytestmark = [
    pytest.mark.shared,
    pytest.mark.skipif(not CASES, reason="needs the practice cases: SHER3_SHARED names the folder with contract/"),
]


@pytest.fixture(scope="module")
def totals(tmp_path_factory):
    """Scores of all cases by the contract's own scorer; the diagnosis gets the case folders alone."""
    verdicts = tmp_path_factory.mktemp("verdicts")
    for case in CASES:
        diagnose_case(case).verdict.write(verdicts / f"{case.name}.json")
    spec = importlib.util.spec_from_file_location("contract_score", SHARED / "score.py")
    scorer = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scorer)
    rows = scorer.score(scorer.load(verdicts, SHARED / "practice"))
    return rows, scorer.totals(rows)


def test_no_practice_case_is_missed_or_falsely_blamed(totals):
    rows, score = totals
    wrong = [(r["case"], r["truth"], r["said"]) for r in rows if r["truth"] != r["said"]]
    assert wrong == []
    assert score["stage_accuracy"][0] == score["actuator_accuracy"][0] == 1.0


def test_the_true_effect_is_named_and_its_closure_is_that_of_the_oracle(totals):
    _, score = totals
    assert score["single_top1"][0] == 1.0
    assert score["single_precision"][0] == 1.0
    assert score["closure_abs_error"][0] < 0.05
