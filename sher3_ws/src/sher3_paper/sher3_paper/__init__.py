"""The SHER 3.0 paper recomputed: deflection, design, bench-top evaluation."""
