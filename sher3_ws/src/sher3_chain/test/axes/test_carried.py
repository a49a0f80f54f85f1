"""Two joints of one arm described as axes: each feels the other, which no cause of its own is."""

import numpy as np
from sher3_chain.axes.machine import Axes
from sher3_chain.chain.view import held_beside
from sher3_chain.joint.description import AxesDescription
from sher3_chain.joint.record import AxesRun
from sher3_diagnosis import diagnose
from slides import columns

T = np.arange(0.0, 20.0, 0.01)
INERTIAS = 0.9, 0.25, 0.3
"""Of both links, of the outer one, and of their coupling, kg m^2 (a planar arm)."""


def waves(*parts):
    """Return position, velocity and acceleration of sines: amplitude, rad/s and phase each."""
    q = sum(a * np.sin(w * T + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * T + p) for a, w, p in parts)
    return q, v, sum(-a * w * w * np.sin(w * T + p) for a, w, p in parts)


def test_joints_that_carry_each_other_are_said_to():
    (q1, v1, a1), (q2, v2, a2) = waves((0.8, 0.7, 0.0), (0.2, 3.0, 1.0)), waves((0.9, 0.9, 2.0), (0.3, 2.6, 0.3))
    both, outer, coupling = INERTIAS
    c, s = np.cos(q2), np.sin(q2)
    first = (both + 2 * coupling * c) * a1 + (outer + coupling * c) * a2 - coupling * s * (2 * v1 * v2 + v2**2)
    second = (outer + coupling * c) * a1 + outer * a2 + coupling * s * v1**2
    noise = 0.02 * np.random.default_rng(0).normal(size=(2, len(T)))
    efforts = {"a": first + 0.5 * np.tanh(v1 / 5e-3) + noise[0], "b": second + 0.2 * np.tanh(v2 / 5e-3) + noise[1]}
    signals = {**columns("position", unit="rad"), **columns("effort", unit="N*m")}
    law = {"motion": "rotary", "signals": signals, "command_law": {"kind": "force"}, "mass": "unknown"}
    axes = [{"name": name, **law, "encoder_resolution": 1e-5} for name in "ab"]
    time = {"column": "t", "unit": "s"}
    machine = Axes(AxesDescription.model_validate({"kind": "axes", "name": "arm", "time": time, "axes": axes}))
    moved = {"a": {"position": q1, "effort": efforts["a"]}, "b": {"position": q2, "effort": efforts["b"]}}
    verdict = diagnose(machine, [AxesRun("run", 0.01, moved)]).verdict
    assert verdict.status == "outside_library"
    assert any("kind: manipulator" in note for note in verdict.notes)


def test_an_axis_that_is_held_while_another_one_moves_is_not_judged():
    """Its controller gives way to the other's forces by thousandths, and its effort is the answer."""
    q, v, a = waves((0.8, 1.7, 0.0), (0.2, 5.0, 1.0))
    noise = np.random.default_rng(0).normal(size=(3, len(T)))
    answer = 0.3 * a + 0.1 * np.tanh(v / 5e-3) + 0.02 * noise[0]
    held, moved = -answer / 300.0 + 1e-5 * noise[1], a + 0.5 * np.tanh(v / 5e-3) + 0.02 * noise[2]
    signals = {**columns("position", unit="rad"), **columns("effort", unit="N*m")}
    law = {"motion": "rotary", "signals": signals, "command_law": {"kind": "force"}, "mass": "unknown"}
    axes = [{"name": name, **law, "encoder_resolution": 1e-5} for name in ("far", "held")]
    time = {"column": "t", "unit": "s"}
    machine = Axes(AxesDescription.model_validate({"kind": "axes", "name": "arm", "time": time, "axes": axes}))
    far = {"position": q, "effort": moved}
    verdict = diagnose(
        machine, [AxesRun("run", 0.01, {"far": far, "held": {"position": held, "effort": answer}})]
    ).verdict
    assert {(c.effect, c.actuator) for c in verdict.causes} == {("coulomb_friction", "far")}
    assert any("held while others move far" in note and "is not judged" in note for note in verdict.notes)


def test_a_joint_beside_one_that_turns_on_and_on_is_not_held_for_that():
    """And joints that slide are held beside those that slide."""
    travels, motions = [300.0, 0.05, 0.02, 0.5, 0.005], ["rotary"] * 3 + ["linear"] * 2
    assert held_beside(travels, motions).tolist() == [False, False, True, False, True]
