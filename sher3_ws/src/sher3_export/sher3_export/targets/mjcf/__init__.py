"""MuJoCo models: what is written where, read whole and written back; `model.py` is the target."""
