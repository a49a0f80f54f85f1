"""The numbers that decide on chains of joints, beside the engine's own: meaning, data they were set on, how to measure.

"Published sets" are those of docs/reference/real-data.md; `sher3 gap import` and `sher3 gap diagnose` print their
verdicts, and `sher3_machines/test/test_real.py` holds them against what is known of each machine. None was tuned to one
of them.
"""

from __future__ import annotations

# -- evidence: what takes the place of runs ------------------------------------------------------------------------

MIN_BLOCK = 4
"""Samples that count in a block at least: a second difference needs three. Set by that argument."""

# -- identification of an unknown mass -----------------------------------------------------------------------------

SLOW = 0.2
"""Share of the rms speed below which samples are left out of the identification: around a reversal dry friction is no
sign function. Set on: the published slide and the simulated slide of `test_axes.py`.
Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_identify.py`."""

LEAST_EXCITED = 2.0
"""Mass over its standard error that an identified mass must have: below two it may as well be none."""

NO_INERTIA = 0.1
"""Share of the effort that a mass may need at most, where the record does not tell it, for friction and weight to be
judged without it. Set by that argument: their intervals are not narrower than a tenth."""

ALIGNED = 0.1
"""Share of the held-out loss that reading the effort half a period earlier or later must save before it is believed.
Set by the argument that noise alone saves a few per cent."""

HELD = 0.02
"""Share of the travel of the axis that moves furthest, a quarter turn at most, below which one beside it is held:
controllers give way by hundredths, and what is asked to move does so by more. Set by that argument.
Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_carried.py`."""

# -- dry friction at rest ------------------------------------------------------------------------------------------

STATIC = 1.5
"""Friction at rest over friction in motion, at most: textbook ratios of dry metal pairs reach 1.5.
Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_balance_at_rest.py`."""

REST_FLOORS = 2.0
"""Floors by which a force at rest must exceed what friction holds before it counts: a floor is a standard deviation,
and two of them are passed by chance once in twenty samples."""

# -- a drive at its limit ------------------------------------------------------------------------------------------

FLAT = 1e-3
"""Share of the largest command within which a command is at the limit: above the rounding of recorded commands.
Set on: the published pendulum. Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_limits.py`."""

PINNED = 0.02
"""Share of a record at the limit from which it is named: a free command touches its largest value for a moment.
Set on and measured as `FLAT`."""

LONGEST = 10
"""Samples in a row for which the command must stay at the limit at least once. Set on and measured as `FLAT`."""

LIMIT_UNCERTAINTY = 0.06
"""Relative half width of a limit's interval at least: the engine's for any parameter of an idealised law."""

LAW_ROUNDED = 1e-3
"""Share of a command below which it is what its law states: gains are written down with three digits. Set by that
argument. Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_law.py`."""

# -- channels that say nothing -------------------------------------------------------------------------------------

DEAD = 0.5
"""Share of the samples in motion at one and the same reading from which a channel is dead. Between a live effort of few
bits (0.02) and the dead ones of a published arm (0.88). Set on: `tiago_dynamics`.
Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_health.py`."""

FOLLOWS = 0.01
"""Share of the axis' travel that a second encoder must at least show: less is its noise. Set by that argument."""

SCALED = 0.2
"""Ratio of two encoders, less one, from which it is their scale and no error of the machine. Set by that argument."""

ALIKE = 0.999
"""Correlation with the axis from which a second encoder follows it, in whatever scale. Set by that argument."""

# -- a serial arm in motion ----------------------------------------------------------------------------------------

CAUSES_OF_JOINT = 5
"""Causes named of one joint at most: dry and viscous friction, a constant force, the drive's gain, and one more.
Set by that count."""

DELAYED = 0.5
"""Share of the difference of two encoders, beside play, spring and scale, that a delay may leave. Set by that argument:
it is most of it. Measure: `pytest sher3_ws/src/sher3_chain/test/manipulator/test_wrong_readings.py`."""

STAYS = 0.1
"""Share of a joint's travel over which a second encoder may stay at one reading: no play is as wide. Set by that
argument. Measured as `DELAYED`."""

SLIPPED = 5.0
"""Factor between an effort and what the model needs, either way, from which its unit is wrong: drives are off by less.
Set by that argument. Measured as `DELAYED`."""

HEAVIEST = 20.0
"""The same factor upwards on a single axis: a payload scales all that is known of it, and drives move no twenty times
their own mass. Set by that argument.
Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_effort_in_units.py`."""

SURELY = 50.0
"""Standard errors that such a factor must have: a payload on a light joint fits one too, badly. Measured as `DELAYED`:
18 with 5 standard errors for a payload of 2 kg on the last joint of an arm, 1000 with thousands for a wrong unit."""

LEAST_CLOSURE = 0.02
"""Share of the gaps of all joints that carry a payload which it must explain: less is what another fault leaves.
Set by argument: the share by which the engine calls two explanations alike.
Measure: `pytest sher3_ws/src/sher3_chain/test/manipulator`."""

CONFOUNDED = 0.1
"""Singular value of the stacked columns, each of length one, below which a combination of quantities cannot be seen: a
change of 10 % of one quantity then hides behind 1 % in power. Set by that argument.
Measure: `pytest sher3_ws/src/sher3_chain/test/manipulator/test_confounding.py`."""

TAKES_PART = 0.3
"""Part of a quantity in such a combination from which it is named. Set and measured as `CONFOUNDED`."""

# -- conditions contrasted -----------------------------------------------------------------------------------------

CHANGES = 3
"""Changes between conditions named at most: as many as causes of one part. Set by that argument."""

# -- noisy encoders ------------------------------------------------------------------------------------------------

NOISE_SHARE = 0.005
"""Share of the acceleration's power that may be the encoder's noise: by so much a mass is too small, half a per cent,
and by so much its interval is wider. Set by that argument.
Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_noise.py`."""

SLOWEST_CUT = 2.0
"""Lowest cut-off of the low-pass, Hz: below it a record of a minute has too few independent samples. Set by that
argument."""
