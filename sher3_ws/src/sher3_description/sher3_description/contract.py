"""Numbers of the recorded-run contract (version 1) that hold for every robot and so stand in no `robot.yaml`."""

GRAVITY = 9.81
"""Acceleration of free fall [m/s^2], along -z of the base (section 3)."""

REFERENCE_TEMPERATURE = 22.0
"""Temperature of the structure [degC] at which the nominal numbers hold (section 7: drift is relative to it)."""

EFFORT_NOISE = 0.002
"""Standard deviation of a reported effort, as a share of the drive's rated force (section 3)."""

EFFORT_RESOLUTION = 0.001
"""Step to which a reported effort is rounded, as a share of the drive's rated force (section 3)."""
