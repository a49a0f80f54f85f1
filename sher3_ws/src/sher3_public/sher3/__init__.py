"""SHER3's public face; `sher3.gap` diagnoses the gap between a robot and its simulation."""
