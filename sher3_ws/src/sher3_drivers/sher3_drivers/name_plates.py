"""The file that says which drives the robot has: vendor, product and serial number of each (YAML, `sher3.drives/1`).

Below `schema: sher3.drives/1` it has `drives`, and under each drive's name
`{vendor: 21320, product: 12291, serial: 1}`.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sher3_common import read_yaml

from sher3_drivers.errors import DriverSettingsError
from sher3_drivers.settings import DriveIdentity, NamePlate

SCHEMA = "sher3.drives/1"


class _File(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")

    schema_: Annotated[Literal["sher3.drives/1"], Field(alias="schema")]
    drives: dict[str, NamePlate]


def load_name_plates(path: Path | str) -> tuple[DriveIdentity, ...]:
    """Return the name plates of a file, in its order; drives that it does not name are not looked at.

    Raises:
        DriverSettingsError: an unknown key, or a number that no object 0x1018 holds; FileError: it cannot be read.
    """
    try:
        file = _File.model_validate(read_yaml(path))
        return tuple(DriveIdentity(drive=name, **plate.model_dump()) for name, plate in file.drives.items())
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "file"
        remedy = f"write `schema: {SCHEMA}` and, for each drive, vendor, product and serial"
        raise DriverSettingsError(f"{path}: {where}: {first['msg']}", value=first.get("input"), remedy=remedy) from None
