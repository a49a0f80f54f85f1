"""Truth plants: robots against which the diagnosis is checked, a folder for each, found by its name.

A plant knows its own laws, faults and solver. It shares with the others only what stands beside the folders: kinds of
faults as data (`kinds`), plan and face of a plant (`plant`), the recorder's format (`recorder`), and flags of
compilation. No plant imports another one, the library of effects or the simulator (`tests/test_rooms.py`).
"""
