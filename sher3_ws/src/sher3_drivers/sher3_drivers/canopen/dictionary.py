"""The table of objects in the form the `canopen` library wants: its object dictionary."""

from __future__ import annotations

from functools import lru_cache

from canopen.objectdictionary import (
    INTEGER8,
    INTEGER16,
    INTEGER32,
    UNSIGNED8,
    UNSIGNED16,
    UNSIGNED32,
    ObjectDictionary,
    ODRecord,
    ODVariable,
)

from sher3_drivers.canopen.objects import OBJECTS, Address, DriveObject

_TYPES = {"u8": UNSIGNED8, "u16": UNSIGNED16, "u32": UNSIGNED32, "i8": INTEGER8, "i16": INTEGER16, "i32": INTEGER32}


@lru_cache(maxsize=1)
def drive_dictionary() -> ObjectDictionary:
    """Return the object dictionary, the same for every drive of the robot; it is built once."""
    dictionary = ObjectDictionary()
    records = {address.main for address in OBJECTS if address.sub}
    for index in sorted({address.main for address in OBJECTS}):
        if index not in records:
            dictionary.add_object(_variable(Address(index, 0), OBJECTS[Address(index, 0)]))
            continue
        record = ODRecord(f"record {index:04X}", index)
        for address, row in OBJECTS.items():
            if address.main == index:
                record.add_member(_variable(address, row))
        dictionary.add_object(record)
    return dictionary


def _variable(address: Address, row: DriveObject) -> ODVariable:
    variable = ODVariable(f"{row.name} {address}", address.main, address.sub)
    variable.data_type = _TYPES[row.kind]
    variable.access_type = row.access
    return variable
