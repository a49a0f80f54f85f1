"""What a page of another machine calls admissible is physically possible: no mass, friction or stiffness below zero."""

from collections.abc import Iterator
from itertools import product

import numpy as np
import pytest
from lifts import friction, motion, needed
from lifts import machine as lift
from sher3_chain.axes.evidence import gather_axis
from sher3_chain.axes.machine import kind_of
from sher3_chain.joint.bounds import least_of
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis.effect import Effect
from sher3_effects import pages
from sher3_effects.compliance.compliance_of_one_encoder import ComplianceBehindMotor
from sher3_effects.lost_motion.backlash_of_one_encoder import BacklashBeforeEncoder, BacklashBehindMotor
from slides import MASS, PERIOD, axis_of, columns, driven

SIGNALS = {**columns("position", "reference", "load"), **columns("command", "effort", unit="N")}
SIZES = (-1e3, -1.0, -1e-3, 1e-3, 1.0, 1e3)
"""Coefficients that are tried, of every sign and size."""
BESIDE_STATED = {("payload_mass", "mass"): -MASS, ("viscous_friction", "extra"): 0.0}
"""Parameters that add to what the slide's description states, and what is left of them at least."""
MANY = 4
"""Coefficients of a page up to which all of these are tried together; of more, random ones."""


def fits(page: Effect, views, site: str) -> Iterator[tuple[dict, np.ndarray]]:
    """Shapes and coefficients of a page that it calls admissible."""
    for shape in page.shapes(views, site)[:40]:
        count = max((x.shape[-1] for x in page.signature(views[0], site, shape).columns.values()), default=0)
        rng = np.random.default_rng(count)
        tried = product(SIZES, repeat=count) if count <= MANY else rng.choice(SIZES, size=(2000, count))
        for c in tried:
            if page.admissible(shape, np.array(c)):
                yield shape, np.array(c)


def pages_of(axis) -> list[Effect]:
    """Every page of an axis: those of one with two encoders, and those that look behind one."""
    behind = [BacklashBehindMotor(MASS), ComplianceBehindMotor(MASS), BacklashBeforeEncoder()]
    return [*pages(kind_of(axis)), *(page for page in behind if kind_of(axis) in page.kinds)]


def slide_view(turning: bool, servo: bool):
    rows = driven(seconds=4.0, coulomb=8.0)
    signals = dict(zip(("position", "reference", "command"), rows.T, strict=True))
    signals |= {"effort": rows[:, 2], "load": rows[:, 0] - 1e-5 * np.sign(np.gradient(rows[:, 0]))}
    changes = {"motion": "rotary" if turning else "linear", "signals": SIGNALS, "mass": MASS, "lead": 0.005}
    axis = axis_of(**changes, **({"command_law": {"kind": "position"}} if servo else {}))
    evidence = gather_axis([AxesRun("run", PERIOD, {"slide": signals})], axis, False)
    return axis, [evidence.records[0]]


@pytest.mark.parametrize("turning", [False, True])
@pytest.mark.parametrize("servo", [False, True])
def test_every_page_of_an_axis(turning, servo):
    axis, views = slide_view(turning, servo)
    seen = 0
    for page in pages_of(axis):
        for shape, c in fits(page, views, "slide"):
            seen += 1
            for name, value in page.parameters(shape, c).items():
                least = BESIDE_STATED.get((page.id, name), least_of(page, name))
                assert least is None or value >= least, (page.id, name, value)
    assert seen > 200


@pytest.mark.parametrize("site", ["lift", "swing"])
def test_every_page_of_a_joint(tmp_path, site):
    both = {
        j: {"signals": {s: {"column": s, "unit": "1"} for s in ("position", "effort", "load")}, "lead": 0.1}
        for j in ("lift", "swing")
    }
    q, v, a = motion(seconds=4.0)
    given = needed(q, v, a) + friction(v, (5.0, 0.5))
    signals = {
        j: {"position": q[:, i], "effort": given[:, i], "load": q[:, i] - 1e-4 * np.sign(v[:, i])}
        for i, j in enumerate(("lift", "swing"))
    }
    machine = lift(tmp_path / "lift.urdf", joint=both)
    (evidence,) = machine.gather([AxesRun("run", 0.005, signals)])
    seen = 0
    for page in machine.effects(evidence):
        place = {"lift": "carriage", "swing": "pendulum"}[site] if page.places == ("link",) else site
        for shape, c in fits(page, evidence.records, place):
            seen += 1
            for name, value in page.parameters(shape, c).items():
                least = least_of(page, name)
                assert least is None or value >= least, (page.id, name, value)
    assert seen > 1000
