"""The file of the drives' name plates: what it says, and what it may not."""

from __future__ import annotations

import pytest
from sher3_drivers.errors import DriverSettingsError
from sher3_drivers.name_plates import load_name_plates

HEAD = "schema: sher3.drives/1\n"
PLATE = "{vendor: 21320, product: 12291, serial: 7}"


def write(tmp_path, text):
    path = tmp_path / "drives.yaml"
    path.write_text(text)
    return path


def test_name_plates_are_read_by_drive(tmp_path):
    (plate,) = load_name_plates(write(tmp_path, f"{HEAD}drives:\n  roll: {PLATE}\n"))
    assert (plate.drive, plate.vendor, plate.product, plate.serial) == ("roll", 0x5348, 0x3003, 7)


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (f"drives: {{roll: {PLATE}}}\n", "schema"),
        (f"schema: sher3.drives/2\ndrives: {{roll: {PLATE}}}\n", "schema"),
        (HEAD + "drives: {roll: {vendor: 1, product: 2}}\n", "drives.roll.serial"),
        (HEAD + "drives: {roll: {vendor: -1, product: 2, serial: 3}}\n", "drives.roll.vendor"),
        (HEAD + "drives: {roll: {vendor: 1, product: 2, serial: 4294967296}}\n", "drives.roll.serial"),
        (HEAD + "drives: [1]\n", "drives"),
    ],
)
def test_what_is_no_name_plate_is_refused_by_its_place(tmp_path, text, part):
    with pytest.raises(DriverSettingsError, match=part):
        load_name_plates(write(tmp_path, text))
