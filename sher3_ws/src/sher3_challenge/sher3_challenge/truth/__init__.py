"""The truth plant: a second, independent robot with its own equations, against which the diagnosis is checked.

It shares no code with `sher3_sim`: Runge-Kutta integration, Maxwell-slip friction, play and hysteresis as stacks of
elements, six links solved numerically, distributed compliance, scatter between robots and between runs.
"""
