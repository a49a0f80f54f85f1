"""Numbers of the recorded-run contract stand in one module."""

import re

import pytest
from sher3_description import contract
from sources import FILES

OF_URDF = ("rigid", "urdf.py")
"""Where the gravity of a URDF stands, which states none: what its readers take, and no number of this contract."""


@pytest.mark.parametrize(
    ("pattern", "value"),
    [
        (r"\b9\.81\b", contract.GRAVITY),
        (r"(?i)(temperature|warmth|climate).*\b22\.0\b", contract.REFERENCE_TEMPERATURE),
        (r"\b0\.002 \* (\w+\.)*rated|hypot\(0\.002", contract.EFFORT_NOISE),
        (r"\b0\.001 \* (\w+\.)*rated", contract.EFFORT_RESOLUTION),
    ],
)
def test_a_number_of_the_contract_is_written_once(pattern, value):
    assert value in (9.81, 22.0, 0.002, 0.001)
    others = [path for path in FILES if path.name != "contract.py" and path.parts[-2:] != OF_URDF]
    assert not [str(path) for path in others if re.search(pattern, path.read_text())]
