"""Draw the picture of the README's part on any robot: one joint recorded, untuned and corrected, and its force.

    python tools/gap_picture.py

The arm is that of docs/how-to/gap-in-six-lines.md, whose elbow has 1.2 N m more dry friction than its model. Left, its
elbow over a second, each window of a quarter started from the recorded state; right, the force that the model leaves
unexplained over the speed, before and after the cause.
"""

from __future__ import annotations

import sys
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("agg")
import matplotlib.pyplot as plt
import sher3.gap as gap

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from documentation.inputs import TWO_LINKS, log_of_two_links  # noqa: E402

INK, STEEL, LIT = "#22303c", "#7d8b97", "#d9480f"


def main() -> None:
    """Write docs/static/gap.png."""
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        log_of_two_links(Path(folder) / "log.npz")
        log = dict(np.load(Path(folder) / "log.npz"))
    answer = gap.diagnose(TWO_LINKS, log["time"], log["control"], log["position"])
    elbow = answer.simulate().joints["elbow"]
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.0, 2.8), layout="constrained", width_ratios=(1.6, 1.0))
    shown = range(4, 12)
    for w in shown:
        for x, colour, width, name in (
            (elbow.recorded, INK, 3.0, "recorded"),
            (elbow.untuned, STEEL, 1.4, "its model"),
            (elbow.corrected, LIT, 1.2, "with the cause"),
        ):
            left.plot(elbow.time[w], x[w], color=colour, lw=width, label=name if w == shown[0] else None)
    left.set(xlabel="time, s", ylabel="elbow, rad")
    left.legend(frameon=False, fontsize="small")
    sizes = f"{elbow.before * 1e3:.0f} mrad rms, {elbow.after * 1e3:.0f} with the cause"
    left.set_title(f"a quarter of a second: {sizes}", loc="left", fontsize="medium")
    names = ["its model", "with the cause"]
    right.barh(names, [answer.places[0].gap, answer.verdict.residual.gap], color=[STEEL, LIT])
    right.axvline(answer.places[0].floor, color=INK, lw=1.0, ls=":")
    right.set(xlabel="unexplained torque, elbow, N m rms")
    right.invert_yaxis()
    right.set_title(answer.headline.split(":")[0], loc="left", fontsize="medium")
    figure.savefig(ROOT / "docs/static/gap.png", dpi=110)
    print(answer.headline, f"{elbow.before:.4g} -> {elbow.after:.4g} rad")


if __name__ == "__main__":
    main()
