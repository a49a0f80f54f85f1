"""CANopen (CiA 301) and the drive profile (CiA 402): objects, states, PDOs, SDO and NMT services of both ends."""
