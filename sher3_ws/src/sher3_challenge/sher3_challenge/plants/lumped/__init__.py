"""The lumped truth plant: an independent robot of formulae with few elements.

It shares no code with `sher3_sim`: Runge-Kutta integration, Maxwell-slip friction, play and hysteresis as stacks of
elements, six links solved numerically, distributed compliance, scatter between robots and between runs.
"""
