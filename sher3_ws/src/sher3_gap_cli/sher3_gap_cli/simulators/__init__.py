"""`sher3 gap compare-simulators`: two traces of the same commands."""
