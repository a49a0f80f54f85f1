"""The SHER 3.0 paper recomputed: deflection, design optimisation, bench-top evaluation."""
