"""The command `benchtop`: what it refuses before anything runs."""

from __future__ import annotations

import json

import pytest
from invoking import invoke
from sher3_bags.errors import BagError
from sher3_benchtop.cli import app
from sher3_bringup.errors import ConfigurationError
from sher3_common import Sher3Error
from sher3_kinematics.errors import Unreachable
from sher3_kinematics.tip_deflection import LoadBeyondRange


def refusal(*arguments: str) -> BaseException:
    """Return the error that a command line ends with."""
    result = invoke(app, list(arguments))
    assert isinstance(result.exception, Sher3Error), result.output
    return result.exception


@pytest.mark.parametrize(
    ("arguments", "kind", "words"),
    [
        (("--nominal", "--as-built"), ConfigurationError, "exclude"),
        (("--test", "grid"), ConfigurationError, "grid_10mm"),
        (("--again",), ConfigurationError, "--out"),
        (("--test", "grid_10mm", "--centre", "40", "0", "0"), Unreachable, "delta_3"),
        (("--test", "deflection", "--force", "-6", "20"), LoadBeyondRange, "limit 12"),
    ],
)
def test_wrong_options_are_refused_with_their_numbers(arguments, kind, words):
    error = refusal(*arguments)
    assert isinstance(error, kind) and words in str(error)


def test_bags_that_are_not_there_are_named(tmp_path):
    error = refusal("--out", str(tmp_path), "--again", "--test", "rotation")
    assert isinstance(error, BagError) and "rotation" in str(error)


def test_spread_prints_percentiles():
    result = invoke(app, ["--spread", "3", "--json"])
    low, middle, high = json.loads(result.output)["accuracy/y_motion/y/mean"]
    assert 0.0 < low < middle < high
