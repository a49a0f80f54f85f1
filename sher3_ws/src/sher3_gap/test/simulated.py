"""Cases made by the simulator, for the tests of what surrounds the diagnosis."""

from sher3_common.samples import JointSample, WrenchSample
from sher3_description import load_robot
from sher3_gap.case.loading import signals_of
from sher3_gap.excitation import excite
from sher3_gap.experiments.rehearsal import rehearse
from sher3_gap.live.monitor import TOPICS
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


def samples(run, ticks=2300):
    """Yield (topic, sample) tick by tick as a graph would deliver them."""
    fields = {t: [run[t].columns.get(f) for f in ("position", "velocity", "effort")] for t in TOPICS[:5]}
    wrench = run["force/measured_cf"]
    for k in range(min(ticks, len(wrench.stamp))):
        stamp = int(wrench.stamp[k])
        for topic, columns in fields.items():
            yield topic, JointSample(stamp, *(None if c is None else tuple(c[k]) for c in columns))
        yield "force/measured_cf", WrenchSample(stamp, (*wrench.force[k], *wrench.torque[k]))
