"""Every number that decides in the diagnosis, in one place: its meaning, the data it was set on, and how to measure it.

Losses are held-out sums of squares over the floor: a sample at its floor adds one. "Development seeds" are the
challenge's seeds 0 to 199 of `--plant lumped`; the command beside a number prints the figures it was chosen from. A
number set on a plant is not shown by that plant.
"""

from __future__ import annotations

# -- tolerances: what is no gap? -----------------------------------------------------------------------------------

VISIBLE = 1.0
"""Loss that a deviation of one standard deviation must add over all runs for the data to see its direction.
Set by that argument: what adds less than a sample's own scatter moves nothing."""

WITHIN = 2.0
"""Uncertainties from which a deviation within its tolerance is told in a verdict: 95 %. Set by that argument."""

# -- localise: is there a gap? -------------------------------------------------------------------------------------

POOLED = {
    "controller": 1.3,
    "drive": 1.3,
    "motor_mechanics": 1.3,
    "transmission": 1.25,
    "mechanism": 2.0,
    "structure": 2.0,
    "sensing": 1.35,
}
"""Power over its allowance, over all runs, from which a channel has a gap when its floor is known from many repeats.
Higher at the tip: a robot as built may be off by as much as the floor there, which no repeat shows.
Set on: healthy development seeds, none of which may pass. Measure: `sher3 gap challenge --kinds healthy`."""

FLOOR_SCATTER = 0.5
"""Share by which those thresholds rise for each lost degree of freedom of the floor (divided by the repeats): a floor
that came out small by chance is no gap. Set on and measured as `POOLED`, with two and three repeats."""

GROUPED = 2.5
"""The threshold for the runs of one excitation: fewer samples than over all runs, and more groups looked at.
Set on and measured as `POOLED`."""

GROUPED_ENCODERS = 3.0
"""The same for the difference of two encoders, of which a slow run has few independent roundings.
Set on and measured as `POOLED`."""

ZERO_COUNTS = 0.75
"""Mean difference of two encoders, in counts of the motor's, from which it is a gap: rounding alone moves a run's mean
by up to half a count. Set by that argument. Measure: `sher3 gap challenge --kinds healthy`."""

EATEN = 0.3
"""Floor over signal from which an absence is no finding: less than three floors of anything would be seen. Set by that
argument. Measure: `pytest sher3_ws/src/sher3_chain/test/axes/test_eaten_signals.py`."""

# -- attribute: which effect? --------------------------------------------------------------------------------------

MAX_CAUSES = 3
"""Causes named at most. Set by the plan of the challenge, whose compound cases have up to three faults."""

PRICE = 12.0
"""Held-out loss that each coefficient or shape parameter must buy: four standard deviations of a chi-square with
eight repeats' worth of searching. Set on: development seeds. Measure: `sher3 gap challenge --seeds 0:40`."""

NEEDED = 3.0 * PRICE
"""Loss that a cause, or the more general of two related effects, must be worth for each of its numbers in order to
stay. Set on and measured as `PRICE`."""

PARSIMONY = 0.004
"""Share of what is explained that a further cause must be worth to stay: laws are idealisations, and what a right law
leaves is not worth a second cause. Set on and measured as `PRICE`."""

OF_THE_REST = 0.2
"""Share of what is left above the floor that a plain law beside other plain laws must be worth where that is less than
`PARSIMONY` asks. Set by the argument that what two laws leave is a law's own error as soon as a third takes less than
half of its amplitude's error. Measure: `python bench/drawn_machines.py`."""

WORTH = 0.35
"""Share of a remaining gap that a further cause must explain. Set on: compound development seeds.
Measure: `sher3 gap challenge --kinds compound`."""

COMPLETE = 0.8
"""Share of a remaining gap above which a single cause is enough and no pair is tried.
Set on and measured as `WORTH`."""

PAIR_GAIN = 0.15
"""Share of a remaining gap by which a pair must beat the best single cause. Set on and measured as `WORTH`."""

PAIR_WORTH = 0.6
"""Share of a remaining gap that a pair must explain. Set on and measured as `WORTH`."""

RIVAL = 0.02
"""A rival explains all but this share of what the chosen effect explains.
Set on: pairs of siblings in the development seeds. Measure: `sher3 gap challenge --seeds 0:40` (set size)."""

CONSTANT = 0.029
"""Share of what a cause explains that letting its size differ between excitations may add. Measured 0.0001 to 0.013
for true effects of the development seeds, 0.03 to 0.12 for effects that stand in for another one.
Measure: `python bench/gap_pattern.py`."""

CERTAIN = 100.0
"""Loss that a varying size must explain before it counts. Set on and measured as `CONSTANT`."""

# -- judge: what may be left? --------------------------------------------------------------------------------------

REMAINDER = 0.10
"""Share of a channel's gap that may be left when its cause is known: laws are idealisations.
Set on: development seeds. Measure: `sher3 gap challenge --seeds 0:40` (status)."""

REMAINDER_OF_COMPLETE = 0.03
"""The same where no cause's page says what a real machine adds to its law: right ones leave less than 1 % beyond small
gaps. Set on and measured as `REMAINDER`."""

SMALL_SHARE = 0.25
"""Share that may be left if what is left is also small. Set on and measured as `REMAINDER`."""

SMALL_REMAINDER = 2.5
"""Power over floor of what is left up to which it is small. Set on and measured as `REMAINDER`."""

REPRODUCED = 0.9
"""Share of an exact stage's error that its causes must reproduce. Set on: development seeds with faults of transport
and controller. Measure: `sher3 gap challenge --seeds 0:40` (status)."""

# -- exact stages: what does the timing of the echo say? -----------------------------------------------------------

SKEW = 0.02
"""Latency in periods from which a command is late, and difference from which two axes are not alike: what a tenth of a
percent of rounded ticks makes. Set on: development seeds of the timing family.
Measure: `sher3 gap challenge --seeds 0:40` (top-1 of the timing family)."""

APART = 0.05
"""Share of the transport's error that latencies of their own must explain beyond a common one.
Set on and measured as `SKEW`."""

RANDOM_SHARE = 0.005
"""Share of the transport's error that latencies of every tick must explain beyond constant ones before random lateness
is looked for. Set on and measured as `SKEW`."""

ANY_JITTER = 0.1
"""Share from which random lateness is jitter even where it scatters little against the latency.
Set on and measured as `SKEW`."""

JITTER_OVER_LATENCY = 0.35
"""Scatter of the ticks' latencies over their median from which lateness is random: a half-normal one has 0.6.
Set on and measured as `SKEW`."""

DROPS_SEEN = 2e-4
"""Share of ticks held for whole periods from which commands are dropped: one in 5000, fewer than two a case.
Set on and measured as `SKEW`."""

DROPS_USUAL = 0.5
"""Share of held ticks above which holding is the rule and no jitter. Set on and measured as `SKEW`."""

MOSTLY_DROPS = 0.5
"""Share of the ticks out of time that must be late by whole periods for them to be drops. Set by that argument: drops
leave a lattice of latencies, jitter a continuum. Measure: `sher3 gap challenge --seeds 0:40`."""

CONTINUUM = 0.1
"""Distance of the quartiles of the ticks' latencies, over their rms, from which lateness may be jitter: that of a
half-normal one is 0.83; where it is nothing most ticks are on time, and what is late is late for a reason.
Set by that argument. Measure: `sher3 gap challenge --kinds outside` (demand_slew)."""

EXACT_UNTIMED = 0.005
"""Share of an exact stage's error in ticks whose timing cannot be told. Set on and measured as `SKEW`."""

SAME_GAIN = (1e-3, 0.02)
"""Difference of the axes' gain errors, absolute and relative, below which they are one error.
Set on: development seeds with `controller_gain`. Measure: `sher3 gap challenge --seeds 0:40`."""

# -- weigh: what is evidence? --------------------------------------------------------------------------------------

COVERED = 0.5
"""Share of a gap that a cause, or the causes of other gaps, must explain for it to be theirs. Set by that argument:
half. Measure: `sher3 gap calibrate`, lines of the status."""

AT_FLOOR = 1.1
"""Mean square over the floor up to which nothing is left that a law could be found in: two standard errors of a floor
that a handful of repeats tells to 5 %. Set by that argument. Measure: `sher3 gap calibrate`, lines of the status."""

SHOWN = 0.1
"""Share of the gap that a resample of the runs must show to tell how far it shrinks: one without the runs that show the
gap does not. Set by argument. Measure: `sher3 gap challenge --seeds 0:40` (coverage of the closure)."""

# -- quantify: how sure are the numbers? ---------------------------------------------------------------------------

MIN_RUNS = 5
"""Fewer runs than this carry no interval: a resample of four runs has too few distinct ones."""

PIECES = 4
"""Pieces of a run whose fits are compared for the intervals of parameters: enough that each excitation gives several,
few enough that each holds several strokes. Repeats share their pieces: a law errs alike in them. Set by that argument.
Measure: `sher3 gap challenge --seeds 0:40` (coverage of the parameters)."""

NORMAL = 1.96
"""Half width of a 95 % interval in standard errors that noise and deviations of known size give."""

MISFIT = 0.05
"""Share of what a law leaves of its gap, as an rms, that may be hidden in its parameters. With 0 to 0.1 the widths are
alike. Set on and measured as `BEYOND`."""

HIDDEN = 0.03
"""The same of what a law may leave below the floor, where nothing shows it: share of a parameter, over gap over floor.
With 0.1 widths are a fifth narrower at the same cover, but with `tables` left out they hold 0.83 of it and not 0.90.
Set on and measured as `BEYOND`."""

BEYOND = 4.4
"""Half width of a parameter's interval in standard errors of its scatter and of what its law leaves: a robot's law
differs from the page's by more than its sizes scatter over the data. Covers 94 % of 247 parameters of the plants
`lumped`, `tables` and `mujoco` and of the practice cases, where 4.4, 3.9 and 4.5 do with one plant left out in turn.
Measure: `python bench/gap_intervals.py`."""

JACKKNIFE = 2.3
"""Half width of a 95 % interval in standard errors of a jackknife over about nine runs (Student's t, 8 degrees)."""

NO_TIP_GAP = 1.2
"""Power over floor of the nominal tip error, less what tolerances make, below which there is nothing there to close.
Set on and measured as `POOLED`."""

# -- regimes and remainders: what a gap looks like -----------------------------------------------------------------

AT_REST = 0.01
"""Share of its top speed below which an axis is at rest. A convention of the words, no decision hangs on it."""

FAST = 0.2
"""Share of its top speed from which an axis is fast. A convention of the words."""

JUST_AFTER = 10
"""Samples that count as just after a reversal: 0.1 s at 100 Hz. A convention of the words."""

WARM = 0.5
"""Range of temperatures [K] from which warm and cool samples are told apart. A convention of the words."""

REGIME_SAMPLES = 20
"""Samples a regime must have before its power is told."""

STANDS_OUT = 1.3
"""Power of a regime over the mean of all from which it is named."""

REGIME_GAP = 1.5
"""Power over floor from which a regime is named."""

LINE_SHARE = 0.15
"""Share of a remainder's power in one spectral line from which its frequency is told."""

PERIOD_SHARE = 0.2
"""Share of a remainder that a period over a motor revolution must explain to be told."""

# -- discover: what may a formula claim? ---------------------------------------------------------------------------

TERMS = 5
"""Terms of a discovered formula at most, for each component: more is no explanation.
Set by that argument. Measure: `python bench/gap_discover.py`."""

TERM_WORTH = 0.02
"""Share of a gap that each term must take off runs left out: less is not worth a clause in a sentence.
Set by that argument. Measure: `python bench/gap_discover.py`."""

PLAIN = 0.002
"""Share of a gap that each further number or law of a term must be worth: of two formulas that fit alike, the plainer.
Set by argument. Measure: `python bench/gap_discover.py`."""

LEAST_COMPONENT = 0.03
"""Share of the largest component's gap from which a formula is looked for in a component too.
Set by argument. Measure: `python bench/gap_discover.py`."""
