"""The tables plant: a robot whose laws are sampled curves and maps instead of formulae.

Friction is a map over speed, position and direction; gears, cables, hysteresis and limits are tables; stages have two
masses with elastic contacts; temperatures lag. Strang splitting in fixed steps advances all axes together.
"""
