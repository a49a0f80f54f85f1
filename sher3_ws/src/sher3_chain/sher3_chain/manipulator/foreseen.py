"""An experiment with an arm as its model foresees it: its own motion, with a known mass on its last link."""

from __future__ import annotations

from collections.abc import Iterator

from sher3_diagnosis.machine import Rehearsal

from sher3_chain.manipulator.description import Carried
from sher3_chain.manipulator.evidence import ArmMotionEvidence, residuals_of
from sher3_chain.manipulator.view import MotionView

SHARE = 0.15
"""Mass that is put on, over that of all links that move: arms carry as much or more by their data sheets."""
BESIDE = (0.1, 0.1, 0.1)
"""Centre of that mass in the frame of the link's joint, m: beside the axis of the joint, so that it feels the mass too,
and within reach of a plate on its flange."""
WHY = (
    "a gain of the drive grows with what it must give, links stay as they are; described as `carried`, beside this "
    "record"
)


def foreseen(evidence: ArmMotionEvidence) -> Iterator[Rehearsal]:
    """Yield the recorded motion with a known mass, to two digits."""
    model = evidence.records[0].model
    mass = float(f"{SHARE * model.mass:.2g}")
    known = Carried(mass=mass, link=model.links[-1], centre=BESIDE)
    views = [
        MotionView(v.run, v.links, v.joints, v.model.carrying(known), v.coupling, v.shares) for v in evidence.records
    ]
    place = ", ".join(f"{x:g}" for x in BESIDE)
    added = f"a known mass of {mass:g} kg on {known.link}, {place} m from its joint along x, y and z"
    data = evidence.foreseen(views, [residuals_of(view, evidence.judged) for view in views])
    yield Rehearsal("the same motion", WHY, added, data)
