"""Cases made by the simulator, for the tests of what surrounds the diagnosis."""

from sher3_description import load_robot
from sher3_gap.case.loading import signals_of
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_sim import RunScatter

ROBOT = load_robot()
SCATTER = RunScatter(zero=0.05)


def runs_of(labels, effects=(), repeats=3, seed=3, **options):
    """Return the runs of `repeats` of every standard excitation."""
    wanted = [(excite(label, ROBOT, **options), repeat) for label in labels for repeat in range(repeats)]
    return rehearse(ROBOT, wanted, effects, seed=seed, scatter=SCATTER)


def signals(runs):
    """Return the runs as the diagnosis sees them."""
    return [signals_of(run, ROBOT, f"run {i}") for i, run in enumerate(runs)]
