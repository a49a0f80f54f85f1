"""The bench-top evaluation: what is commanded, what two cameras see of it, and the figures made from that.

Plain functions of numbers: `sher3_bringup.benchtop` drives the graph through the timelines made here.
"""
