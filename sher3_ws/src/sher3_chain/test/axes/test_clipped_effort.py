"""An effort at the largest value it can show is named; what is identified from the rest is the machine."""

import numpy as np
import pytest
from sher3_chain.joint.record import AxesRun
from sher3_chain.readings.level import at_a_level
from sher3_chain.readings.signals import limited_by_reading
from sher3_diagnosis import diagnose
from sher3_machines import MachineError
from slides import MASS, PERIOD, columns, driven, machine

FORCE = {"signals": {**columns("position"), **columns("effort", unit="N")}, "command_law": {"kind": "force"}}


@pytest.fixture(scope="module")
def rows():
    return driven(coulomb=8.0, viscous=20.0)


def clipped(rows, low, high, **changes):
    """Diagnose the slide by its effort alone, clipped at shares of its largest value."""
    effort = rows[:, 2] + 0.05 * np.random.default_rng(5).normal(size=len(rows))
    most = np.abs(effort).max()
    effort = np.clip(effort, low * most, high * most)
    return diagnose(
        machine(**{**FORCE, **changes}), [AxesRun("run", PERIOD, {"slide": {"position": rows[:, 0], "effort": effort}})]
    ).verdict


@pytest.mark.parametrize("limits", [(-0.15, 0.15), (-1.0, 0.15)], ids=["both ways", "one way"])
def test_a_clipped_effort_leaves_mass_and_friction(rows, limits):
    found = clipped(rows, *limits, mass="unknown")
    causes = {c.effect: c.parameters for c in found.causes}
    assert set(causes) == {"coulomb_friction", "viscous_friction"}
    assert causes["coulomb_friction"]["force"].value == pytest.approx(8.0, rel=0.03)
    (said,) = (n for n in found.notes if "mass identified as" in n)
    assert float(said.split()[4]) == pytest.approx(MASS, rel=0.02)
    assert any("run: slide.effort lies flat at its largest reading" in n for n in found.notes)


@pytest.mark.parametrize("mass", [MASS, "unknown"])
def test_where_hardly_anything_is_left_the_refusal_names_the_level(rows, mass):
    with pytest.raises(MachineError, match=r"slide.effort lies flat at its largest reading in \d+%"):
        clipped(rows, -0.08, 0.08, mass=mass)


def test_constant_forces_and_few_bits_are_no_level():
    t = np.arange(4000)
    wave = np.sin(t / 300.0)
    assert at_a_level(np.minimum(wave, 0.8)).mean() == pytest.approx(0.2, abs=0.02)
    assert not at_a_level(wave).any()
    assert not at_a_level(np.sign(np.sin(t / 100.0 + 0.1))).any(), "a test with constant forces"
    assert not at_a_level(np.round(4.0 * wave)).any(), "few bits"
    polled = np.clip(60.0 * np.sin(t / 100.0 + 0.1), 0.0, 1.0)
    assert 0.0 < np.mean((polled > 0.0) & (polled < 1.0)) < 0.02, "it passes from level to level in a few samples"
    assert not at_a_level(polled).any(), "a duty of two levels, put on another clock"


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_load_of_nothing_is_no_level(sense):
    """A weight as large as the friction: down it goes by itself, and the drive gives exactly nothing."""
    load = np.maximum(np.sin(np.arange(4000) / 300.0), 0.0)
    assert not at_a_level(sense * load).any()
    assert at_a_level(sense * np.minimum(load, 0.8)).mean() == pytest.approx(0.2, abs=0.02), "a limit beside it"


def test_a_command_that_lies_flat_too_is_what_the_drive_gives():
    wave = np.minimum(np.sin(np.arange(4000) / 300.0), 0.8)
    assert limited_by_reading({"effort": wave, "command": wave}) is None
    assert limited_by_reading({"effort": wave, "command": 2.0 * np.sin(np.arange(4000) / 300.0)}) is not None
