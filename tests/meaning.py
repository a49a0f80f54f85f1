"""What no verdict may say: a cause of no size, an estimate outside its own interval, a number of no known order."""

from sher3_diagnosis.judge.meaning import SPAN
from sher3_diagnosis.verdict import Verdict

SIZES = frozenset(
    {
        *("force", "extra", "relative", "arm", "share", "stiffness", "amplitude", "width", "mass", "inertia", "limit"),
        *("time_constant", "load_delay", "effort_delay", "delay", "offset", "angle", "length", "linear", "wrap"),
    }
)
"""Parameters that say how much of an effect there is."""
TELLS = {"presliding_friction": "displacement", "gear_loss": "share", "position_friction": "amplitude"}
"""Effect -> what tells it from a plain dry friction."""


def meaningless(verdict: Verdict) -> list[str]:
    """Return a sentence for each cause that says nothing."""
    out = []
    for c in verdict.causes:
        told = {n: p for n, p in c.parameters.items() if p.low is not None and p.high is not None}
        out += [f"{c.effect} {n} misses {p.value}" for n, p in told.items() if not p.low <= p.value <= p.high]
        zero = {n for n, p in told.items() if p.low <= 0.0 <= p.high}
        sizes = SIZES & told.keys()
        wide = {n for n in sizes if told[n].low > 0.0 and told[n].high > SPAN * told[n].low}
        if sizes and sizes <= wide and any(told[n].means is None for n in sizes):
            out.append(f"{c.effect} of {c.actuator} tells numbers of no known order: {sorted(wide)}")
        if (sizes and sizes <= zero) or (TELLS.get(c.effect) in zero):
            out.append(f"{c.effect} of {c.actuator} holds zero in {sorted(zero)}")
        if c.closure.value <= 0.0:
            out.append(f"{c.effect} of {c.actuator} closes {c.closure.value}")
    return out
