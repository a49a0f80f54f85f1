"""Sealed cases from a truth plant, diagnosed blind and scored beside baselines on the same cases.

Two sides never meet but in `run.py`. The side that knows (`truth`, `cases`, `oracle`) imports neither the engine nor
the pages of the effects nor the simulator; the side that answers (`answers`, `baselines`) imports nothing of the first.
"""
