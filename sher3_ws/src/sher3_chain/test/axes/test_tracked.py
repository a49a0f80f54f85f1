"""An axis whose effort tells no force balance is judged by how it follows its reference."""

import numpy as np
import pytest
from scipy.signal import lfilter
from sher3_chain.axes import evidence
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns, machine

COUNT = 1e-4


def hobby_servo(seed):
    """A servo of drawn lag that reports a duty of a few steps, which says nothing of its force."""
    draw = np.random.default_rng(seed)
    period, lag = 0.01, draw.uniform(0.05, 0.2)
    t, fine = np.arange(0.0, 40.0, period), np.arange(0.0, 40.0, 0.1 * period)
    asked = 0.4 * np.sin(0.9 * t) + 0.1 * np.sin(draw.uniform(2.0, 5.0) * t) + 0.2 * np.sign(np.sin(0.37 * t))
    keep = np.exp(-0.1 * period / lag)
    place = lfilter([1.0 - keep], [1.0, -keep], np.interp(fine, t, asked))[::10]
    signals = {
        "position": COUNT * np.round(place / COUNT),
        "reference": asked,
        "effort": np.round(draw.uniform(0.0, 3.0, len(t))) * (draw.random(len(t)) > 0.5),
    }
    return lag, AxesRun("run", period, {"slide": signals})


@pytest.mark.parametrize("seed", range(4))
def test_a_duty_that_tells_no_force_leaves_the_tracking_to_be_judged(seed):
    lag, run = hobby_servo(seed)
    signals = columns("position", "reference", "effort")
    described = machine(mass="unknown", signals=signals, encoder_resolution=COUNT, command_law={"kind": "force"})
    verdict = diagnose(described, [run]).verdict
    assert [c.effect for c in verdict.causes] == ["drive_lag"]
    assert verdict.causes[0].parameters["time_constant"].value == pytest.approx(lag, rel=0.1)
    assert any("judged by how it follows its reference" in note for note in verdict.notes)


@pytest.mark.parametrize(("times", "judged"), [(1.0, False), (1e6, True)])
def test_forces_below_their_floor_leave_the_tracking_to_be_judged(monkeypatch, times, judged):
    """A drive that reports what it gives ten times a second: nobody foresees more than it."""
    own = evidence.floors_of
    floors = lambda *given: [{c: times * floor for c, floor in found.items()} for found in own(*given)]  # noqa: E731
    monkeypatch.setattr(evidence, "floors_of", floors)
    _, run = hobby_servo(0)
    place = run.signals["slide"]["position"]
    force = 3.0 * np.gradient(np.gradient(place, run.period), run.period) + 2.0 * np.gradient(place, run.period)
    run = AxesRun("run", run.period, {"slide": {**run.signals["slide"], "effort": force}})
    signals = columns("position", "reference", "effort")
    described = machine(mass=3.0, signals=signals, encoder_resolution=COUNT, command_law={"kind": "force"}).described
    found = evidence.gather_axis([run], described.axes[0], False)
    assert found.axis.servo == judged and any("judged by how it follows" in note for note in found.notes) == judged
